#include "live/alerting.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "knowledge/describe.h"
#include "knowledge/presence.h"

namespace culprit::live {
namespace {

// Not a name that rules could have.
std::string key_of_component(const std::string& name) { return "component " + name; }
std::string key_of_blindness(const std::string& cause) { return "blind by " + cause; }

std::vector<std::string> names_of_rules(const std::vector<RuleId>& ids, const RuleSet& rules) {
  std::vector<std::string> names;
  for (const RuleId id : ids) names.push_back(rules[id].name);
  return names;
}

bool is_missing(ComponentId id, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[id];
  return knowledge.rules[id].is_required && (state.is_missed || state.alive == false);
}

// Whether a strategy of the rule adapts the component and does not start it. One that a strategy starts may be in
// reserve.
bool needs(const Rule& rule, ComponentId id, const RuleSet& rules) {
  if (!std::ranges::count(rule.repaired, id)) return false;
  return std::ranges::none_of(rule.strategies, [&](StrategyId strategy) {
    return std::ranges::any_of(rules[strategy].adaptations, [&](const Adaptation& each) {
      return each.component == id && each.type == AdaptationType::kStart;
    });
  });
}

// The rules of level ERROR that can see and need a component that was never seen. Those that are blind have an alert
// of their own.
std::vector<RuleId> rules_without(ComponentId id, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  std::vector<RuleId> all;
  if (presence_of(id, knowledge) != Presence::kNeverSeen) return all;
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    const Rule& rule = rules.rules[r];
    const bool matters = rule.policies.criticality == Criticality::kError &&
                         !knowledge.blindness[RuleId(r)] && needs(rule, id, rules);
    if (matters) all.emplace_back(r);
  }
  return all;
}

bool is_about(const alerts::Alert& alert, const std::string& component) {
  return std::find(alert.components.begin(), alert.components.end(), component) !=
         alert.components.end();
}

}  // namespace

void Alerting::begins(const Manager& manager, std::function<Remarks()> /*remarks*/,
                      Time /*start*/) {
  manager_ = &manager;
}

void Alerting::stepped(const Runtime::Step& step) {
  if (step.events.empty() && step.now < due_) return;
  note(step.events);
  look(step.now);
}

void Alerting::note(std::span<const Event> events) {
  const RuleSet& rules = manager_->knowledge().rules;
  for (const Event& event : events) {
    if (const auto* resolved = std::get_if<FailureResolved>(&event.what)) {
      resolved_[rules[resolved->rule].name] = describe(event, rules);
    } else if (const auto* lost = std::get_if<FailureLost>(&event.what)) {
      lost_sight_.insert(rules[lost->rule].name);
    } else if (const auto* flaps = std::get_if<FailureFlaps>(&event.what)) {
      flapping_.insert(rules[flaps->rule].name);
    }
  }
}

void Alerting::forget_what_is_seen_again() {
  if (lost_sight_.empty()) return;
  const Knowledge& knowledge = manager_->knowledge();
  std::set<std::string> unknown;
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    const RuleState& state = knowledge.states[RuleId(r)];
    if (state.phase == RulePhase::kQuiet && !state.detection.trigger.known)
      unknown.insert(knowledge.rules.rules[r].name);
  }
  std::erase_if(lost_sight_, [&](const std::string& rule) { return !unknown.contains(rule); });
}

std::vector<Alerting::Problem> Alerting::problems() const {
  const RuleSet& rules = manager_->knowledge().rules;
  std::vector<Problem> all;
  for (const Incident& each : manager_->incidents().open()) {
    Incidents::Course course = manager_->course_of(each);
    Problem problem;
    alerts::Alert& alert = problem.alert;
    alert.id = each.id;
    alert.needs_person = each.needs_person();
    alert.headline = each.headline;
    problem.tells_condition = !each.condition.empty();
    alert.health = each.is_exhausted ? "EXHAUSTED" : std::string(to_string(each.criticality));
    alert.rule = rules[each.root].name;
    for (const ComponentId c : each.components) alert.components.push_back(rules[c].name);
    alert.consequences = names_of_rules(each.consequences, rules);
    alert.doing = std::move(course.doing);
    // Any other next step has passed before a person reads the alert.
    if (each.needs_person() || each.has_no_remedy) alert.next = std::move(course.next);
    problem.needs_person_if_it_lasts = each.has_no_remedy;
    problem.keys = {alert.consequences.begin(), alert.consequences.end()};
    problem.keys.insert(alert.rule);
    for (const std::string& name : alert.components) problem.keys.insert(key_of_component(name));
    const auto flaps = [this](const std::string& rule) { return flapping_.contains(rule); };
    if (std::any_of(problem.keys.begin(), problem.keys.end(), flaps)) {
      alert.needs_person = true;
      alert.doing += "; it comes and goes";
    }
    all.push_back(std::move(problem));
  }
  for (Problem& each : problems_of_the_whole()) {
    const bool is_told = std::any_of(all.begin(), all.end(), [&](const Problem& other) {
      return !each.alert.components.empty() && is_about(other.alert, each.alert.components[0]);
    });
    if (!is_told) all.push_back(std::move(each));
  }
  for (Problem& each : problems_of_sight()) all.push_back(std::move(each));
  return all;
}

// Rules that are blind for the same input are one problem, and so are all if no rule can see.
std::vector<Alerting::Problem> Alerting::problems_of_sight() const {
  const Knowledge& knowledge = manager_->knowledge();
  const RuleSet& rules = knowledge.rules;
  std::map<std::string, std::vector<RuleId>> by_cause;
  std::set<std::string> causes;
  for (const RuleId id : knowledge.blindness.rules()) {
    const std::string& input = knowledge.blindness[id]->input;
    const std::string cause = key_of_blindness(input.empty() ? rules[id].name : input);
    causes.insert(cause);
    by_cause[knowledge.blindness.is_total() ? "" : cause].push_back(id);
  }
  std::vector<Problem> all;
  for (const auto& [cause, blind] : by_cause) {
    const auto less_critical = [&](RuleId a, RuleId b) {
      return rules[a].policies.criticality < rules[b].policies.criticality;
    };
    const RuleId worst = *std::max_element(blind.begin(), blind.end(), less_critical);
    const std::size_t others = blind.size() - 1;
    const std::string names = cause.empty() ? "watching nothing, no rule can see"
                              : others == 0
                                  ? rules[worst].name + " is blind"
                                  : fmt::format("{} and {} more {} blind", rules[worst].name,
                                                others, others == 1 ? "rule are" : "rules are");
    Problem& problem = all.emplace_back();
    problem.keys = cause.empty() ? causes : std::set{cause};
    problem.alert.rule = rules[worst].name;
    problem.alert.health = std::string(to_string(rules[worst].policies.criticality));
    problem.alert.headline = names + ": " + describe(*knowledge.blindness[worst]);
    problem.alert.doing = "failures of these rules stay unnoticed";
    problem.needs_person_if_it_lasts = true;
  }
  return all;
}

// Problems that no rule covers.
std::vector<Alerting::Problem> Alerting::problems_of_the_whole() const {
  const Knowledge& knowledge = manager_->knowledge();
  std::vector<Problem> all;
  const auto add = [&](const std::string& key, const std::string& headline,
                       const std::string& doing) -> Problem& {
    Problem& problem = all.emplace_back();
    problem.keys = {key};
    problem.alert.headline = headline;
    problem.alert.health = "ERROR";
    problem.alert.doing = doing;
    return problem;
  };
  if (const auto& storm = manager_->governor().storm())
    add("storm in general", "much of the robot fails at once",
        "nothing more is done: " + storm->reason)
        .alert.needs_person = true;
  if (!manager_->hears())
    add("deafness in general", "culprit receives nothing from the robot",
        "nothing is judged, and nothing is done");
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    const bool is_required = is_missing(ComponentId(c), knowledge);
    const auto rules =
        is_required ? std::vector<RuleId>() : rules_without(ComponentId(c), knowledge);
    if (!is_required && rules.empty()) continue;
    const std::string& name = knowledge.rules.components[c].name;
    Problem& missing =
        is_required ? add(key_of_component(name), name + " is REQUIRED and is not there", "")
                    : add(key_of_component(name), name + " was never seen",
                          "it is needed by " + listed(names_of_rules(rules, knowledge.rules)));
    missing.alert.components = {name};
    missing.needs_person_if_it_lasts = true;  // a rule may be about to do something
  }
  return all;
}

// Returns the fault that shares a rule or a component with the problem, now or a moment ago; else a new one. If several do, the one that was already reported
// is preferred.
Alerting::Fault& Alerting::fault_of(const Problem& problem, Time now) {
  std::vector<std::size_t> same;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const auto has = [&](const std::string& key) { return faults_[i].keys.contains(key); };
    if (std::any_of(problem.keys.begin(), problem.keys.end(), has)) same.push_back(i);
  }
  if (same.empty()) {
    Fault fault;
    fault.began = now;
    fault.alert.began = wall_();
    fault.alert.id = problem.alert.id;
    if (fault.alert.id.empty())  // no incident, but what keeps culprit from finding any
      fault.alert.id = fmt::format("{:x}-{}", std::llround(1000 * fault.alert.began),
                                   problem.alert.rule.empty() ? "robot" : problem.alert.rule);
    faults_.push_back(std::move(fault));
    return faults_.back();
  }
  std::stable_sort(same.begin(), same.end(), [this](std::size_t a, std::size_t b) {
    return faults_[a].is_told && !faults_[b].is_told;
  });
  for (std::size_t i = 1; i < same.size(); ++i)
    close_part(faults_[same[i]], problem.alert.headline);
  return faults_[same.front()];
}

// It turned out to be part of another one.
void Alerting::close_part(Fault& part, const std::string& whole) {
  part.keys.clear();
  if (!std::exchange(part.is_told, false)) return;
  part.alert.state = alerts::Alert::State::kResolved;
  part.alert.needs_person = part.was_person_needed;
  part.alert.ended = wall_();
  part.alert.doing = "it is part of another fault: " + whole;
  part.alert.next.clear();
  post_(part.alert);
}

void Alerting::take(Problem problem, Time now) {
  Fault& fault = fault_of(problem, now);
  fault.gone = kNever;
  // A fault that split in two is reported as one at first; the worse part gives it its name.
  if (std::exchange(fault.looked_at, now) == now) {
    fault.alert.doing += "; also: " + problem.alert.headline;
    is_one_of_two_ = true;
    return;
  }
  for (const std::string& key : problem.keys) fault.keys[key] = now;
  std::erase_if(fault.keys, [&](const auto& key) { return later(key.second, kStaysAway) <= now; });
  problem.alert.needs_person |=
      problem.needs_person_if_it_lasts && later(fault.began, options_.wait) <= now;
  problem.alert.id = fault.alert.id;
  problem.alert.began = fault.alert.began;
  if (problem.tells_condition) fault.condition = problem.alert.headline;
  fault.alert = std::move(problem.alert);
}

void Alerting::look(Time now) {
  forget_what_is_seen_again();
  is_one_of_two_ = false;
  for (Problem& problem : problems()) take(std::move(problem), now);
  for (Fault& fault : faults_) {
    const auto is_unseen = [this](const auto& key) { return lost_sight_.contains(key.first); };
    const bool is_there =
        fault.looked_at == now || std::any_of(fault.keys.begin(), fault.keys.end(), is_unseen);
    if (!is_there && fault.gone == kNever) {
      fault.gone = now;
      fault.alert.ended = wall_();
    }
    if (is_there && fault.looked_at != now)
      fault.alert.doing = "it is not observable any more; it is unknown whether it has cleared";
    tell(fault, now);
  }
  std::erase_if(faults_, [&](Fault& fault) { return is_over(fault, now); });
  due_ = kNever;
  for (const Fault& fault : faults_) due_ = std::min(due_, next_due(fault));
  if (is_one_of_two_) due_ = std::min(due_, later(now, kStaysAway));
  if (!lost_sight_.empty()) due_ = std::min(due_, later(now, std::chrono::seconds(1)));
}

void Alerting::tell(Fault& fault, Time now) {
  const bool is_needed = fault.gone == kNever && fault.alert.needs_person;
  const bool is_new = is_needed && !fault.is_person_needed;
  const bool is_due =
      !fault.is_told && fault.gone == kNever && later(fault.began, options_.wait) <= now;
  fault.is_person_needed = is_needed;
  fault.was_person_needed |= is_needed;
  fault.alert.robot = manager_->knowledge().rules.robot;
  fault.alert.host = options_.host;
  if (options_.link) fault.alert.link = options_.link();
  if (!is_new && !is_due) return;
  fault.is_told = true;
  post_(fault.alert);
}

// If so, a message reports it.
bool Alerting::is_over(Fault& fault, Time now) {
  if (fault.keys.empty()) return true;
  if (fault.gone == kNever || now < later(fault.gone, kStaysAway)) return false;
  fault.alert.state = alerts::Alert::State::kResolved;
  fault.alert.needs_person = fault.was_person_needed;
  fault.alert.next.clear();
  if (!fault.condition.empty()) fault.alert.headline = fault.condition;
  const auto how = resolved_.find(fault.alert.rule);
  fault.alert.doing = how == resolved_.end() ? "" : how->second;
  post_(fault.alert);
  for (const auto& [key, seen] : fault.keys) flapping_.erase(key);
  return true;
}

Time Alerting::next_due(const Fault& fault) const {
  if (fault.gone != kNever) return later(fault.gone, kStaysAway);
  return fault.is_told ? kNever : later(fault.began, options_.wait);
}

}  // namespace culprit::live
