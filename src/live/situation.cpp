#include "live/situation.h"

#include <algorithm>

#include "knowledge/describe.h"

namespace culprit::live {
namespace {

bool contains(const auto& all, const auto& each) {
  return std::find(all.begin(), all.end(), each) != all.end();
}

bool is_failing(RuleId rule, const Knowledge& knowledge) {
  return knowledge.states[rule].phase != RulePhase::kQuiet;
}

std::vector<RuleId> failures_of(const Knowledge& knowledge) {
  std::vector<RuleId> all;
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    if (is_failing(RuleId(r), knowledge)) all.emplace_back(r);
  }
  return all;
}

std::string names_of_components(const std::vector<ComponentId>& components, const RuleSet& rules) {
  std::vector<std::string> names;
  for (const ComponentId c : components) names.push_back(rules[c].name);
  return listed(names);
}

// "dead", "stopped", "hung"; empty: it works, as far as is known.
std::string_view condition_of(const ComponentState& state) {
  if (!state.alive || *state.alive) return "";
  if (state.process == ProcessState::kStopped) return "stopped";
  return state.hangs() ? "hung" : "dead";
}

// Their common condition; empty: they work, or differ.
std::string_view condition_of(const std::vector<ComponentId>& components,
                              const Knowledge& knowledge) {
  std::string_view all;
  for (const ComponentId c : components) {
    const std::string_view each = condition_of(knowledge.components[c]);
    if (c != components.front() && each != all) return "";
    all = each;
  }
  return all;
}

// "camera is dead", "fusion hangs", "camera and fusion are held responsible", "rover2, where
// camera and lidar ran, is unreachable".
std::string headline_of(const Incident& incident, bool is_suspected, const Knowledge& knowledge) {
  const std::string who = names_of_components(incident.components, knowledge.rules);
  const bool are_many = incident.components.size() > 1;
  const std::string are = are_many ? " are " : " is ";
  if (!incident.host.empty()) return incident.host + ", where " + who + " ran, is unreachable";
  if (incident.condition == "hung") return who + (are_many ? " hang" : " hangs");
  if (!incident.condition.empty()) return who + are + incident.condition;
  if (incident.is_certain) return who + are + "held responsible";
  if (is_suspected) return who + are + "suspected";
  return knowledge.rules[incident.root].name + " fails";
}

// "3.2s"
std::string time_until(Time at, Time now) {
  using Tenths = std::chrono::duration<std::int64_t, std::deci>;
  return to_string(Duration(std::chrono::ceil<Tenths>(std::max(at - now, Duration::zero()))));
}

// The next step for a failure that is being repaired, and its time.
std::string next_of_exhausted(RuleId rule, const Knowledge& knowledge) {
  const auto& strategies = knowledge.rules[rule].strategies;
  const bool goes_on = std::any_of(strategies.begin(), strategies.end(), [&](StrategyId id) {
    return knowledge.only_starts_the_gone(knowledge.rules[id]);
  });
  if (!goes_on) return "nothing more is tried: a person must look";
  return "a person must look; the process that is gone is started again in " +
         time_until(knowledge.states[rule].search.retry_at, knowledge.now);
}

std::string next_of(RuleId rule, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  const RuleState& state = knowledge.states[rule];
  if (state.phase == RulePhase::kExhausted) return next_of_exhausted(rule, knowledge);
  if (state.attempt) {
    const std::string& strategy = rules[state.attempt->strategy].name;
    switch (state.attempt->stage) {
      case Attempt::Stage::kAdapting:
        return strategy + " is being carried out";
      case Attempt::Stage::kUndoing:
        return "what " + strategy + " changed is being undone";
      default:
        break;
    }
    if (state.attempt->deadline == kNever) return "waits for the symptom to go";
    return "if the symptom is not gone in " + time_until(state.attempt->deadline, knowledge.now) +
           ", the next strategy is tried";
  }
  if (state.settling)
    return "it is expected to go away with " + rules[state.settling->with].name + ", within " +
           time_until(state.settling->until, knowledge.now);
  if (state.search.retry_at > knowledge.now)
    return "all strategies are tried again in " + time_until(state.search.retry_at, knowledge.now);
  return "";
}

}  // namespace

Situation::Failure& Situation::of(RuleId rule, const RuleSet& rules) {
  failures_.resize(rules.rules.size());
  return failures_[rule.index];
}

const Situation::Failure& Situation::of(RuleId rule) const {
  static const Failure nothing;
  return rule.index < failures_.size() ? failures_[rule.index] : nothing;
}

void Situation::take(std::span<const Event> events, const RuleSet& rules) {
  for (const Event& event : events) take(event, rules);
}

void Situation::take(const Event& event, const RuleSet& rules) {
  if (const auto* detected = std::get_if<FailureDetected>(&event.what)) {
    of(detected->rule, rules) = {};
  } else if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
    of(rules[chosen->strategy].rule, rules) = {.candidates = chosen->candidates,
                                               .suspects = chosen->suspects,
                                               .blamed = chosen->strategy,
                                               .is_advice = chosen->dry_run,
                                               .explains = chosen->explains};
  } else if (const auto* asked = std::get_if<ApprovalAsked>(&event.what)) {
    of(rules[asked->strategy].rule, rules) = {
        .candidates = asked->candidates, .suspects = asked->suspects, .blamed = asked->strategy};
  } else if (const auto* held = std::get_if<ActionHeldBack>(&event.what)) {
    // The failure is known to be its own cause all the same.
    Failure& failure = of(rules[held->strategy].rule, rules);
    failure.held_back = held->reason;
    failure.blamed = held->strategy;
    failure.is_held_back = false;
  } else if (const auto* waiting = std::get_if<FailureHeldBack>(&event.what)) {
    Failure& failure = of(waiting->rule, rules);
    failure.candidates = waiting->candidates;
    failure.suspects = waiting->suspects;
    failure.is_held_back = true;
    const bool is_of_another =
        std::any_of(waiting->candidates.begin(), waiting->candidates.end(),
                    [](const Candidate& c) { return c.failure.has_value(); });
    if (is_of_another) failure.blamed.reset();
  }
}

// The manager wants to do something about this very failure.
bool Situation::is_own(RuleId rule) const { return of(rule).blamed && !of(rule).is_held_back; }

// The failure that is held to be its cause.
std::optional<RuleId> Situation::upstream_of(RuleId rule, const std::vector<RuleId>& all) const {
  if (is_own(rule)) return std::nullopt;
  for (const RuleId other : all) {
    if (other != rule && of(other).blamed && contains(of(other).explains, rule)) return other;
  }
  const Failure& failure = of(rule);
  if (!failure.is_held_back) return std::nullopt;
  for (const Candidate& each : failure.candidates) {
    if (each.failure && *each.failure != rule && contains(all, *each.failure)) return each.failure;
  }
  const bool is_suspect_there = !failure.suspects.empty() && failure.suspects[0].failure != rule &&
                                contains(all, failure.suspects[0].failure);
  return is_suspect_there ? std::optional(failure.suspects[0].failure) : std::nullopt;
}

RuleId Situation::root_of(RuleId rule, const std::vector<RuleId>& all) const {
  std::vector<RuleId> way{rule};
  for (auto next = upstream_of(rule, all); next && !contains(way, *next);
       next = upstream_of(rule, all))
    way.push_back(rule = *next);
  return rule;
}

// The computer that the failure waits for; empty: it waits for none.
std::string Situation::unheard_host(RuleId root, const Knowledge& knowledge) const {
  const Failure& failure = of(root);
  if (!failure.is_held_back) return "";
  for (const Candidate& each : failure.candidates) {
    if (each.excluded == Condition::kUnheard && knowledge.is_unheard(each.component))
      return knowledge.host_of(each.component);
  }
  return "";
}

void Situation::blame(Incident& incident, const Knowledge& knowledge) const {
  const RuleSet& rules = knowledge.rules;
  incident.host = unheard_host(incident.root, knowledge);
  for (std::size_t c = 0; !incident.host.empty() && c < rules.components.size(); ++c) {
    const ComponentId component(c);
    if (knowledge.is_unheard(component) && knowledge.host_of(component) == incident.host)
      incident.components.push_back(component);
  }
  incident.is_certain = !incident.host.empty();
  if (incident.is_certain) return;
  const Failure& root = of(incident.root);
  if (root.blamed && !rules[*root.blamed].components.empty()) {
    incident.components = rules[*root.blamed].components;
    incident.is_certain = true;
    return;
  }
  const std::vector<ComponentId>& all = rules[incident.root].components;
  for (const ComponentId c : all) {
    if (!condition_of(knowledge.components[c]).empty()) incident.components.push_back(c);
  }
  if (!incident.components.empty()) return;
  incident.components = root.suspects.empty() ? all : std::vector{root.suspects[0].component};
}

std::string Situation::doing_about(const Incident& incident, const Manager& manager) const {
  const RuleSet& rules = manager.knowledge().rules;
  const Failure& root = of(incident.root);
  const RulePhase phase = manager.knowledge().states[incident.root].phase;
  if (!incident.host.empty())
    return "culprit starts nothing in their place until it is reachable again";
  if (phase == RulePhase::kExhausted) return "nothing helped";
  if (manager.governor().is_paused()) return "nothing is done: culprit is paused";
  if (incident.awaits_approval && root.blamed)
    return "waits for approval: " + actions_of(rules[*root.blamed], rules);
  if (root.blamed && phase == RulePhase::kAttempting)
    return "being repaired: " + actions_of(rules[*root.blamed], rules);
  if (root.blamed && root.is_advice)
    return "would be repaired: " + actions_of(rules[*root.blamed], rules);
  if (!root.held_back.empty()) return "not repaired: " + root.held_back;
  return "nothing is done yet";
}

std::vector<Incident> Situation::incidents(const Manager& manager) const {
  const Knowledge& knowledge = manager.knowledge();
  const RuleSet& rules = knowledge.rules;
  const std::vector<RuleId> all = failures_of(knowledge);
  std::vector<Incident> incidents;
  const auto with_root = [&](RuleId root) -> Incident& {
    const auto same = std::find_if(incidents.begin(), incidents.end(),
                                   [&](const Incident& i) { return i.root == root; });
    if (same != incidents.end()) return *same;
    incidents.push_back({.root = root});
    blame(incidents.back(), knowledge);
    return incidents.back();
  };
  for (const RuleId rule : all) {
    Incident& incident = with_root(root_of(rule, all));
    if (rule != incident.root) incident.consequences.push_back(rule);
  }
  // Two rules may point at one component, none of them at the other.
  std::vector<Incident> merged;
  for (Incident& each : incidents) {
    const auto same = std::find_if(merged.begin(), merged.end(), [&](const Incident& i) {
      return i.components == each.components && !i.components.empty();
    });
    if (same == merged.end()) {
      merged.push_back(std::move(each));
      continue;
    }
    same->consequences.push_back(each.root);
    same->consequences.insert(same->consequences.end(), each.consequences.begin(),
                              each.consequences.end());
  }
  const std::vector<StrategyId> asked = manager.governor().asked();
  for (Incident& incident : merged) {
    std::vector<RuleId> own{incident.root};
    own.insert(own.end(), incident.consequences.begin(), incident.consequences.end());
    for (const RuleId rule : own) {
      const RuleState& state = knowledge.states[rule];
      incident.since = std::min(incident.since, state.failing_since);
      incident.criticality = std::max(incident.criticality, rules[rule].policies.criticality);
      incident.is_exhausted |= state.phase == RulePhase::kExhausted;
      incident.awaits_approval |= std::any_of(asked.begin(), asked.end(), [&](StrategyId strategy) {
        return rules[strategy].rule == rule;
      });
    }
    incident.condition = incident.host.empty() ? condition_of(incident.components, knowledge)
                                               : std::string_view("not heard");
    incident.headline = headline_of(incident, !of(incident.root).suspects.empty(), knowledge);
    incident.doing = doing_about(incident, manager);
    incident.next = incident.host.empty()
                        ? next_of(incident.root, knowledge)
                        : "a person must look: is it on, and connected? Then it goes on by itself";
  }
  std::stable_sort(merged.begin(), merged.end(), [](const Incident& a, const Incident& b) {
    if (a.needs_person() != b.needs_person()) return a.needs_person();
    return a.criticality != b.criticality ? a.criticality > b.criticality : a.since < b.since;
  });
  return merged;
}

}  // namespace culprit::live
