#include "plan/bayes/test_scene.h"

#include <algorithm>
#include <stdexcept>

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::plan {

Scene::Scene(const std::string& text) {
  const Source source("test.rules", text);
  Checked checked = check(source);
  for (const Diagnostic& d : checked.diagnostics) {
    if (d.severity == Severity::kError) ADD_FAILURE() << render(d, source);
  }
  rules_ = std::make_unique<RuleSet>(checked.rules.value_or(RuleSet{}));
  knowledge_ = std::make_unique<Knowledge>(*rules_);
  for (std::size_t c = 0; c < rules_->components.size(); ++c) {
    ComponentState& state = knowledge_->components[ComponentId(c)];
    state.alive = true;
    state.lifecycle = Lifecycle::kActive;
    knowledge_->graph.node_appeared(rules_->components[c].node);
    knowledge_->discovered.note(ComponentId(c), Time{});
  }
  knowledge_->now = Time(std::chrono::seconds(100));
}

Scene& Scene::link(const std::string& producer, const std::string& consumer) {
  const std::string topic = "/" + producer + "/out";
  knowledge_->graph.endpoint_appeared("/" + producer, EndpointKind::kPublisher, topic);
  knowledge_->graph.endpoint_appeared("/" + consumer, EndpointKind::kSubscriber, topic);
  return *this;
}

Scene& Scene::fail(const std::string& name, Duration delay) {
  RuleState& state = knowledge_->states.state(rule(name));
  state.failing_since = Time(std::chrono::seconds(90)) + delay;
  state.detection.trigger = Slot::of(true);
  knowledge_->states.enter(rule(name), RulePhase::kFailing);
  return *this;
}

Scene& Scene::see_working(const std::string& name) {
  Detection& detection = knowledge_->states.state(rule(name)).detection;
  detection.trigger = Slot::of(false);
  detection.last_false = knowledge_->now;
  return *this;
}

Scene& Scene::attempt(const std::string& name, Attempt::Stage stage) {
  const StrategyId id = strategy(name);
  const RuleId owner = (*rules_)[id].rule;
  fail((*rules_)[owner].name);
  RuleState& state = knowledge_->states.state(owner);
  state.attempt.emplace();
  state.attempt->strategy = id;
  state.attempt->stage = stage;
  knowledge_->states.enter(owner, RulePhase::kAttempting);
  return *this;
}

Scene& Scene::exhaust(const std::string& name) {
  fail(name);
  knowledge_->states.enter(rule(name), RulePhase::kExhausted);
  return *this;
}

Scene& Scene::tried(const std::string& name) {
  const StrategyId id = strategy(name);
  const auto& siblings = (*rules_)[(*rules_)[id].rule].strategies;
  const auto place = std::find(siblings.begin(), siblings.end(), id) - siblings.begin();
  knowledge_->states.state((*rules_)[id].rule).search.tried[static_cast<std::size_t>(place)] = true;
  return *this;
}

void Scene::process(const std::string& name, ProcessState state) {
  knowledge_->components[component(name)].process = state;
  knowledge_->components[component(name)].alive = state == ProcessState::kRunning;
}

RuleId Scene::rule(const std::string& name) const {
  for (std::size_t r = 0; r < rules_->rules.size(); ++r) {
    if (rules_->rules[r].name == name) return RuleId(r);
  }
  throw std::logic_error("no rule " + name);
}

StrategyId Scene::strategy(const std::string& name) const {
  const std::size_t dot = name.find('.');
  for (const StrategyId id : (*rules_)[rule(name.substr(0, dot))].strategies) {
    if ((*rules_)[id].name == name.substr(dot + 1)) return id;
  }
  throw std::logic_error("no strategy " + name);
}

ComponentId Scene::component(const std::string& name) const {
  for (std::size_t c = 0; c < rules_->components.size(); ++c) {
    if (rules_->components[c].name == name) return ComponentId(c);
  }
  throw std::logic_error("no component " + name);
}

std::string Scene::plan(const Planner& planner) {
  std::vector<RuleId> failures;
  for (const RuleId id : knowledge_->states.active()) {
    if (knowledge_->states[id].phase == RulePhase::kFailing) failures.push_back(id);
  }
  decisions_ = planner.plan(failures, *knowledge_);
  std::vector<std::string> chosen;
  for (const Decision& decision : decisions_) {
    if (decision.chosen)
      chosen.push_back((*rules_)[decision.rule].name + "." + (*rules_)[*decision.chosen].name);
  }
  std::sort(chosen.begin(), chosen.end());
  std::string out;
  for (const std::string& one : chosen) out += (out.empty() ? "" : " ") + one;
  return out;
}

const Decision& Scene::decision(const std::string& name) const {
  for (const Decision& decision : decisions_) {
    if (decision.rule == rule(name)) return decision;
  }
  throw std::logic_error("no decision on " + name);
}

const Candidate& Scene::candidate(const std::string& name) const {
  const StrategyId id = strategy(name);
  for (const Candidate& candidate : decision((*rules_)[(*rules_)[id].rule].name).candidates) {
    if (candidate.strategy == id) return candidate;
  }
  throw std::logic_error("no candidate " + name);
}

std::string failure_of(const std::string& component, const std::string& rule,
                       const std::string& level) {
  return "COMPONENT " + component + " NODE /" + component + " LAUNCH \"" + component + "\"\nRULE " +
         rule + "\n  POLICIES " + level + "\n  TRIGGER x > 1\n" +
         "    STRATEGY restart 50 10\n      ADAPTATION " + component + " restart 2\n" +
         "    STRATEGY redeploy 90 10\n      ADAPTATION " + component + " redeploy 10\n";
}

}  // namespace culprit::plan
