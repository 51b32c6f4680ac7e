#include "incidents/incidents.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/invariant.h"
#include "knowledge/describe.h"

namespace culprit {
namespace {

bool contains(const auto& all, const auto& each) {
  return std::find(all.begin(), all.end(), each) != all.end();
}

// Ascending.
std::vector<RuleId> failures_of(const Knowledge& knowledge) {
  std::vector<RuleId> all;
  for (const auto* list : {&knowledge.states.active(), &knowledge.states.exhausted()}) {
    std::ranges::copy_if(*list, std::back_inserter(all),
                         [&](RuleId id) { return knowledge.states.has_failure(id); });
  }
  std::ranges::sort(all, {}, &RuleId::index);
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

// "camera is down", "fusion hangs", "camera and fusion are held responsible", "rover2, where
// camera and lidar ran, is unreachable".
std::string headline_of(const Incident& incident, const Knowledge& knowledge) {
  const std::string names = names_of_components(incident.components, knowledge.rules);
  const bool are_many = incident.components.size() > 1;
  const std::string are = are_many ? " are " : " is ";
  if (!incident.host.empty()) return incident.host + ", where " + names + " ran, is unreachable";
  if (incident.condition == "hung") return names + (are_many ? " hang" : " hangs");
  if (incident.condition == "dead") return names + are + "down";
  if (!incident.condition.empty()) return names + are + incident.condition;
  if (incident.is_certain) return names + are + "held responsible";
  if (incident.is_suspected) return names + are + "suspected";
  return knowledge.rules[incident.root].name + " fails";
}

// False if the components are not known.
bool acts_on_none(const std::vector<RuleId>& failures, const std::vector<ComponentId>& components,
                  const RuleSet& rules) {
  const auto acts_on_one = [&](StrategyId strategy) {
    return std::ranges::any_of(rules[strategy].components,
                               [&](ComponentId c) { return contains(components, c); });
  };
  return !components.empty() && std::ranges::none_of(failures, [&](RuleId failure) {
    return std::ranges::any_of(rules[failure].strategies, acts_on_one);
  });
}

// "3.2 s"
std::string time_until(Time at, Time now) {
  using Tenths = std::chrono::duration<std::int64_t, std::deci>;
  const auto tenths = std::chrono::ceil<Tenths>(std::max(at - now, Duration::zero())).count();
  const std::string seconds = std::to_string(tenths / 10);
  return tenths % 10 == 0 ? seconds + " s" : seconds + "." + std::to_string(tenths % 10) + " s";
}

std::string outcome_of_exhausted(RuleId rule, const Knowledge& knowledge) {
  if (knowledge.rules[rule].strategies.empty()) return "its rule only reports";
  const bool is_tried = knowledge.states[rule].search.attempts > 0;
  return is_tried ? "nothing helped" : "nothing could be tried";
}

std::string next_of_exhausted(RuleId rule, const Knowledge& knowledge) {
  const auto& strategies = knowledge.rules[rule].strategies;
  const auto next =
      std::ranges::find_if(strategies, [&](StrategyId id) { return knowledge.goes_on(id); });
  if (next == strategies.end()) {
    const bool is_tried = knowledge.states[rule].search.attempts > 0;
    return is_tried ? "nothing more is tried: a person must look" : "a person must look";
  }
  if (!knowledge.only_starts_the_gone(knowledge.rules[*next]))
    return "a person must look; " + knowledge.rules[*next].name +
           " is tried once its WHEN condition is true";
  return "a person must look; culprit starts the exited process again in " +
         time_until(knowledge.states[rule].search.retry_at, knowledge.now);
}

// Empty: nobody ended its components.
std::string why_it_stays_down(const Incident& incident, const Knowledge& knowledge) {
  for (const ComponentId c : incident.components) {
    const auto departure = knowledge.departures.of(c, knowledge.now);
    if (departure && departure->what == Departures::What::kStaysDown)
      return describe(*departure, knowledge.rules[c].name) + "; culprit revive starts it again";
  }
  return "";
}

// The next step for a failure that is being repaired, and its time.
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
        return "culprit undoes " + strategy;
      case Attempt::Stage::kWaiting:
      case Attempt::Stage::kSuspended:
      case Attempt::Stage::kOver:
        break;
    }
    if (state.attempt->deadline == kNever) return "waits until it clears";
    return "if it does not clear in " + time_until(state.attempt->deadline, knowledge.now) +
           ", culprit tries the next strategy";
  }
  if (state.settling)
    return "expected to clear with " + rules[state.settling->with].name + ", within " +
           time_until(state.settling->until, knowledge.now);
  if (state.search.retry_at > knowledge.now)
    return "all strategies are tried again in " + time_until(state.search.retry_at, knowledge.now);
  return "";
}

std::string in_base_36(std::uint64_t number) {
  constexpr std::string_view kDigits = "0123456789abcdefghijklmnopqrstuvwxyz";
  std::string text;
  for (; number > 0 || text.empty(); number /= kDigits.size())
    text.insert(text.begin(), kDigits[number % kDigits.size()]);
  return text;
}

// FNV-1a: the same on every machine.
std::uint64_t hash_of(std::string_view text) {
  constexpr std::uint64_t kOffset = 14'695'981'039'346'656'037U;
  constexpr std::uint64_t kPrime = 1'099'511'628'211U;
  std::uint64_t hash = kOffset;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * kPrime;
  return hash;
}

using ById = std::map<std::string_view, const Incident*>;
ById by_id(const std::vector<Incident>& all) {
  ById ids;
  for (const Incident& each : all) ids.emplace(each.id, &each);
  return ids;
}

bool shares_failure(const Incident& a, const Incident& b) {
  return a.has(b.root) ||
         std::ranges::any_of(b.consequences, [&](RuleId rule) { return a.has(rule); });
}

}  // namespace

Incidents::Failure& Incidents::of(RuleId rule, const RuleSet& rules) {
  failures_.resize(rules.rules.size());
  return failures_[rule.index];
}

const Incidents::Failure& Incidents::of(RuleId rule) const {
  static const Failure nothing;
  return rule.index < failures_.size() ? failures_[rule.index] : nothing;
}

void Incidents::note(const Event& event, const RuleSet& rules) {
  if (const auto* detected = std::get_if<FailureDetected>(&event.what)) {
    of(detected->rule, rules) = {};
  } else if (const auto* lost = std::get_if<FailureLost>(&event.what)) {
    of(lost->rule, rules).is_lost = true;
  } else if (const auto* order = std::get_if<OrderAccepted>(&event.what)) {
    if (std::holds_alternative<Resume>(order->order.what)) resume();
  } else if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
    // A last resort protects the robot from the failure; what it adapts is not the cause.
    if (rules[chosen->strategy].is_last_resort) return;
    of(rules[chosen->strategy].rule, rules) = {.candidates = chosen->candidates,
                                               .suspects = chosen->suspects,
                                               .blamed = chosen->strategy,
                                               .is_advice = chosen->dry_run,
                                               .explains = chosen->explains};
  } else if (const auto* asked = std::get_if<ApprovalAsked>(&event.what)) {
    of(rules[asked->strategy].rule, rules) = {
        .candidates = asked->candidates, .suspects = asked->suspects, .blamed = asked->strategy};
  } else if (const auto* held = std::get_if<ActionHeldBack>(&event.what)) {
    if (rules[held->strategy].is_last_resort) return;
    // The failure is known to be its own cause all the same.
    Failure& failure = of(rules[held->strategy].rule, rules);
    if (!held->candidates.empty()) {
      failure.candidates = held->candidates;
      failure.suspects = held->suspects;
    }
    failure.held_back = held->reason;
    failure.is_paused = held->restraint == Restraint::kPaused;
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

// A pause that is over holds nothing back, whether or not something was decided since.
void Incidents::resume() {
  for (Failure& each : failures_) {
    if (std::exchange(each.is_paused, false)) each.held_back.clear();
  }
}

// The manager wants to do something about this very failure.
bool Incidents::is_own(RuleId rule) const { return of(rule).blamed && !of(rule).is_held_back; }

// The failure that is held to be its cause.
std::optional<RuleId> Incidents::upstream_of(RuleId rule, const std::vector<RuleId>& all) const {
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

RuleId Incidents::root_of(RuleId rule, const std::vector<RuleId>& all) const {
  std::vector<RuleId> way{rule};
  for (auto next = upstream_of(rule, all); next && !contains(way, *next);
       next = upstream_of(rule, all))
    way.push_back(rule = *next);
  return rule;
}

// The computer that the failure waits for; empty: it waits for none.
std::string Incidents::unheard_host(RuleId root, const Knowledge& knowledge) const {
  const Failure& failure = of(root);
  if (!failure.is_held_back) return "";
  for (const Candidate& each : failure.candidates) {
    if (each.excluded == Condition::kUnheard && knowledge.is_unheard(each.component))
      return knowledge.host_of(each.component);
  }
  return "";
}

// The supplier that is down, that the failure waits for, and that no rule is about.
std::optional<ComponentId> Incidents::supplier_down(RuleId root, const Knowledge& knowledge) const {
  const Failure& failure = of(root);
  if (!failure.is_held_back) return std::nullopt;
  for (const Candidate& each : failure.candidates) {
    if (each.excluded == Condition::kDependency && !each.failure &&
        !condition_of(knowledge.components[each.component]).empty())
      return each.component;
  }
  return std::nullopt;
}

void Incidents::blame(Incident& incident, const Knowledge& knowledge) const {
  const RuleSet& rules = knowledge.rules;
  incident.host = unheard_host(incident.root, knowledge);
  for (std::size_t c = 0; !incident.host.empty() && c < rules.components.size(); ++c) {
    const ComponentId component(c);
    if (knowledge.is_unheard(component) && knowledge.host_of(component) == incident.host)
      incident.components.push_back(component);
  }
  incident.is_certain = !incident.host.empty();
  if (incident.is_certain) return;
  if (const auto supplier = supplier_down(incident.root, knowledge)) {
    incident.components = {*supplier};
    return;
  }
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

Incidents::Course Incidents::course_of(const Incident& incident, const Knowledge& knowledge,
                                       Halt halt) const {
  const RuleSet& rules = knowledge.rules;
  if (!incident.host.empty())
    return {"culprit starts nothing in their place until the host is reachable again",
            "a person must look: is the host on, and connected? Then culprit continues by itself"};
  const Failure& root = of(incident.root);
  const RulePhase phase = knowledge.states[incident.root].phase;
  const std::string actions = root.blamed ? actions_of(rules[*root.blamed], rules) : "";
  const std::string down = why_it_stays_down(incident, knowledge);
  std::string doing = down.empty() ? "nothing is done yet" : "not repaired: " + down;
  if (phase == RulePhase::kExhausted) {
    doing = outcome_of_exhausted(incident.root, knowledge);
  } else if (halt == Halt::kDeaf) {
    return {"nothing is judged or done: culprit does not receive the robot's messages", ""};
  } else if (halt == Halt::kPaused) {
    doing = "nothing is done: culprit is paused";
  } else if (incident.awaits_approval && root.blamed) {
    doing = "waits for approval: " + actions;
  } else if (root.blamed && phase == RulePhase::kAttempting) {
    doing = "being repaired: " + actions;
  } else if (root.blamed && root.is_advice) {
    doing = "would be repaired: " + actions;
  } else if (!root.held_back.empty()) {
    doing = "not repaired: " + root.held_back;
  }
  if (incident.has_no_remedy && phase == RulePhase::kFailing && root.is_held_back)
    return {std::move(doing), "a person must look: no rule of these failures acts on " +
                                  names_of_components(incident.components, rules)};
  return {std::move(doing), next_of(incident.root, knowledge)};
}

// Each failure belongs to one incident.
std::vector<Incident> Incidents::found(const Knowledge& knowledge) const {
  const std::vector<RuleId> all = failures_of(knowledge);
  std::vector<Incident> by_root;
  std::map<std::size_t, std::size_t> places;  // in `by_root`, by the root
  for (const RuleId rule : all) {
    const RuleId root = root_of(rule, all);
    const auto [same, is_new] = places.try_emplace(root.index, by_root.size());
    if (is_new) {
      by_root.push_back({.root = root});
      blame(by_root.back(), knowledge);
    }
    if (rule != root) by_root[same->second].consequences.push_back(rule);
  }
  // Two rules may point at one component, none of them at the other.
  std::vector<Incident> merged;
  std::map<std::vector<std::size_t>, std::size_t> by_components;  // places in `merged`
  for (Incident& each : by_root) {
    std::vector<std::size_t> components;
    for (const ComponentId c : each.components) components.push_back(c.index);
    const auto [same, is_new] = by_components.try_emplace(std::move(components), merged.size());
    if (is_new || each.components.empty()) {
      merged.push_back(std::move(each));
      continue;
    }
    std::vector<RuleId>& consequences = merged[same->second].consequences;
    consequences.push_back(each.root);
    consequences.insert(consequences.end(), each.consequences.begin(), each.consequences.end());
  }
  for (Incident& each : merged) std::ranges::sort(each.consequences, {}, &RuleId::index);
  return merged;
}

void Incidents::describe_all(std::vector<Incident>& all, const Knowledge& knowledge,
                             const Orders& orders) const {
  const RuleSet& rules = knowledge.rules;
  for (Incident& incident : all) {
    std::vector<RuleId> own{incident.root};
    own.insert(own.end(), incident.consequences.begin(), incident.consequences.end());
    for (const RuleId rule : own) {
      const RuleState& state = knowledge.states[rule];
      incident.since = std::min(incident.since, state.failing_since);
      incident.criticality = std::max(incident.criticality, rules[rule].policies.criticality);
      incident.is_exhausted |= state.phase == RulePhase::kExhausted;
      incident.awaits_approval |= std::ranges::any_of(
          orders.asked, [&](StrategyId strategy) { return rules[strategy].rule == rule; });
    }
    incident.has_no_remedy = acts_on_none(own, incident.components, rules);
    incident.is_suspected = !incident.is_certain && !of(incident.root).suspects.empty();
    incident.condition = incident.host.empty() ? condition_of(incident.components, knowledge)
                                               : std::string_view("not heard");
    incident.headline = headline_of(incident, knowledge);
  }
}

// "mywpiwzf-0k7": when it began, by the clock on the wall, and what tells it from another incident of that moment.
std::string Incidents::new_id(const Incident& incident, const RuleSet& rules,
                              const std::vector<Incident>& all) const {
  constexpr std::int64_t kNanosecondsInMillisecond = 1'000'000;
  constexpr std::size_t kSuffix = 3;           // letters
  constexpr std::uint64_t kSuffixes = 46'656;  // 36^3
  const std::int64_t wall = ids_.wall_at_zero + incident.since.time_since_epoch().count();
  const std::string began = in_base_36(
      static_cast<std::uint64_t>(std::max<std::int64_t>(0, wall) / kNanosecondsInMillisecond));
  for (std::uint64_t hash = hash_of(ids_.salt + '\n' + rules[incident.root].name);; ++hash) {
    std::string suffix = in_base_36(hash % kSuffixes);
    suffix.insert(0, kSuffix - std::min(kSuffix, suffix.size()), '0');
    std::string id = began + "-" + suffix;
    const auto is_it = [&](const Incident& each) { return each.id == id; };
    if (std::ranges::none_of(all, is_it) && std::ranges::none_of(open_, is_it)) return id;
  }
}

void Incidents::identify(std::vector<Incident>& all, const RuleSet& rules) const {
  const auto take = [&](Incident& incident, const Incident& before) {
    incident.id = before.id;
    incident.since = std::min(incident.since, before.since);
  };
  std::vector<bool> is_root(rules.rules.size());
  std::vector<const Incident*> by_root(rules.rules.size());
  for (const Incident& each : open_) by_root[each.root.index] = &each;
  for (Incident& incident : all) {
    is_root[incident.root.index] = true;
    if (const Incident* before = by_root[incident.root.index]) take(incident, *before);
  }
  std::ranges::sort(all, comes_before);
  for (Incident& incident : all) {
    if (!incident.id.empty()) continue;
    const auto before = std::ranges::find_if(open_, [&](const Incident& each) {
      return !is_root[each.root.index] && shares_failure(incident, each) &&
             std::ranges::find(all, each.id, &Incident::id) == all.end();
    });
    if (before != open_.end()) {
      take(incident, *before);
    } else {
      incident.id = new_id(incident, rules, all);
    }
  }
  std::ranges::sort(all, comes_before);
}

void Incidents::close(const Incident& before, const std::vector<Incident>& all, Time now,
                      EventLog& events) const {
  IncidentClosed closed{before.id, before.root, IncidentEnd::kResolved, ""};
  const auto into =
      std::ranges::find_if(all, [&](const Incident& each) { return shares_failure(each, before); });
  if (into != all.end()) {
    closed.how = IncidentEnd::kMerged;
    closed.into = into->id;
  } else if (of(before.root).is_lost) {
    closed.how = IncidentEnd::kLost;
  }
  events.tell(now, std::move(closed));
}

void Incidents::advance(const Knowledge& knowledge, const Orders& orders, EventLog& events) {
  for (const Event& event : events) note(event, knowledge.rules);
  std::vector<Incident> all = found(knowledge);
  if (all.empty() && open_.empty()) return;
  describe_all(all, knowledge, orders);
  identify(all, knowledge.rules);
  const ById were = by_id(open_);
  for (const Incident& each : all) {
    const auto before = were.find(each.id);
    if (before == were.end()) {
      events.tell(knowledge.now, IncidentOpened{each});
    } else if (*before->second != each) {
      events.tell(knowledge.now, IncidentChanged{each});
    }
  }
  const ById are = by_id(all);
  CULPRIT_ASSERT(are.size() == all.size());  // an id names one incident
  for (const Incident& before : open_) {
    if (!are.contains(before.id)) close(before, all, knowledge.now, events);
  }
  open_ = std::move(all);
}

}  // namespace culprit
