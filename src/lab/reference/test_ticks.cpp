#include "reference/test_ticks.h"

#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>

#include "language/checker.h"
#include "reference/sunset_blackboard.h"

namespace culprit::test {

RuleSet rules_of(const std::string& text) {
  const Source source("test.rules", text);
  Checked checked = check(source);
  for (const Diagnostic& d : checked.diagnostics) {
    if (d.severity == Severity::kError) ADD_FAILURE() << render(d, source);
  }
  return checked.rules.value_or(RuleSet{});
}

std::string sunset_reference_rules() {
  std::ifstream in("rules/sunset-reference.rules", std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

study::ReferenceOptions without_s(bool dependencies, bool criticality) {
  study::ReferenceOptions options;
  options.switches = {dependencies, criticality, false};
  return options;
}

Ticks::Ticks(study::ReferenceOptions options, const std::string& rules)
    : rules_(std::make_unique<RuleSet>(rules_of(rules))) {
  if (options.initial.empty()) options.initial = study::sunset_blackboard();
  auto made = study::ReferenceManager::make(*rules_, options);
  if (!made) ADD_FAILURE() << made.error();
  manager_ = std::move(*made);
  for (const char* component : {"camera", "depth", "fusion"}) publish(component, component);
  subscribe("fusion", "camera");
  subscribe("fusion", "depth");
  subscribe("segmentation", "fusion");
}

void Ticks::publish(const std::string& component, const std::string& topic) {
  for (const Component& c : rules_->components) {
    if (c.name == component)
      observe(EndpointAppeared{c.node, EndpointKind::kPublisher, "/managed_subsystem/" + topic});
  }
}

void Ticks::subscribe(const std::string& component, const std::string& topic) {
  for (const Component& c : rules_->components) {
    if (c.name == component)
      observe(EndpointAppeared{c.node, EndpointKind::kSubscriber, "/managed_subsystem/" + topic});
  }
}

void Ticks::signal(const std::string& name, Value value) {
  for (std::size_t s = 0; s < rules_->signals.size(); ++s) {
    if (rules_->signals[s].name == name) return observe(SignalRead{SignalId(s), std::move(value)});
  }
  ADD_FAILURE() << "the rules have no signal " << name;
}

void Ticks::run(int ticks) {
  for (int t = 0; t < ticks; ++t) {
    ++tick_;
    step(manager_->next_deadline());
    // A restart asks a second time, between the ticks.
    while (!unanswered_.empty()) {
      for (const Command& command : std::exchange(unanswered_, {})) {
        const std::string& component = (*rules_)[command.component].name;
        if (mute.contains(component)) continue;
        const bool says_no = refusing.contains(component);
        observe(Reply{command.id, says_no ? Outcome::kRefused : Outcome::kDone, {}, ""});
      }
      step(now_ + std::chrono::milliseconds(1));
    }
  }
}

void Ticks::observe(ObservationWhat what) { inbox_.push_back({now_, std::move(what)}); }

void Ticks::step(Time now) {
  now_ = now;
  const auto commands = manager_->step(now_, std::exchange(inbox_, {}));
  for (const Command& command : commands) {
    asked.push_back(std::to_string(tick_) + " " + (*rules_)[command.component].name + ": " +
                    to_string(command));
    unanswered_.push_back(command);
  }
  for (const Event& event : manager_->events()) {
    events.push_back(event);
    if (const std::string line = words(event); !line.empty())
      said.push_back(std::to_string(tick_) + " " + line);
  }
}

std::string Ticks::words(const Event& event) const {
  const auto rule = [&](RuleId id) { return (*rules_)[id].name; };
  const auto strategy = [&](StrategyId id) { return (*rules_)[id].name; };
  if (const auto* e = std::get_if<FailureDetected>(&event.what)) return rule(e->rule) + " detected";
  if (const auto* e = std::get_if<StrategyChosen>(&event.what))
    return strategy(e->strategy) + " chosen";
  if (const auto* e = std::get_if<StrategyFailed>(&event.what))
    return strategy(e->strategy) + " failed";
  if (const auto* e = std::get_if<FailureResolved>(&event.what))
    return rule(e->rule) + (e->strategy ? " resolved by " + strategy(*e->strategy) : " went away");
  if (const auto* e = std::get_if<RuleExhausted>(&event.what)) return rule(e->rule) + " exhausted";
  return "";
}

bool Ticks::has_said(const std::string& line) const {
  return std::find(said.begin(), said.end(), line) != said.end();
}

bool Ticks::has_asked(const std::string& line) const {
  return std::find(asked.begin(), asked.end(), line) != asked.end();
}

std::string Ticks::transcript() const {
  std::string text = "\nsaid:\n";
  for (const std::string& line : said) text += "  " + line + "\n";
  text += "asked:\n";
  for (const std::string& line : asked) text += "  " + line + "\n";
  return text;
}

StrategyId Ticks::strategy(const std::string& name) const {
  for (std::size_t s = 0; s < rules_->strategies.size(); ++s) {
    if (rules_->strategies[s].name == name) return StrategyId(s);
  }
  ADD_FAILURE() << "the rules have no strategy " << name;
  return {};
}

}  // namespace culprit::test
