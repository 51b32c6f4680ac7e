#include "knowledge/describe.h"

#include <algorithm>
#include <cstdio>

#include "base/duration_words.h"
#include "base/joined.h"
#include "base/name_grammar.h"

namespace culprit {
namespace {

std::string percents(double probability) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f %%", 100 * probability);
  return text;
}

class Describer {
 public:
  explicit Describer(const RuleSet& rules) : rules_(rules) {}

  std::string operator()(const FailureDetected& e) const {
    const Rule& rule = rules_[e.rule];
    return rule.name + " detected (" + std::string(to_string(rule.policies.criticality)) + ")" +
           (e.known_dead ? ": " + rules_[*e.known_dead].name + " is known to be down, " + e.how
                         : "");
  }
  std::string operator()(const FailureResolved& e) const {
    const std::string after = " after " + two_decimals(seconds(e.reaction)) + " s";
    if (e.strategy) return rules_[e.rule].name + " resolved by " + rules_[*e.strategy].name + after;
    const Rule& rule = rules_[e.rule];
    return rule.name + " cleared" +
           (rule.strategies.empty() ? "" : " without a repair of its own") + after;
  }
  std::string operator()(const FailureLost& e) const {
    return rules_[e.rule].name +
           " can no longer be evaluated: the inputs of its trigger are unknown";
  }
  std::string operator()(const StrategyChosen& e) const {
    const Strategy& strategy = rules_[e.strategy];
    std::vector<std::string> blamed;
    const auto& repaired = rules_[strategy.rule].repaired;
    for (const ComponentId component : strategy.components) {
      const bool is_only_paused =
          !repaired.empty() && !std::ranges::binary_search(repaired, component);
      if (!is_only_paused) blamed.push_back(rules_[component].name);
    }
    std::vector<std::string> failures{rules_[strategy.rule].name};
    for (const RuleId explained : e.explains) failures.push_back(rules_[explained].name);
    std::vector<std::string> ended;
    for (const ComponentId component : e.also_ended) ended.push_back(rules_[component].name);
    const std::string with = ended.empty() ? "" : ", which also ends " + listed(ended);
    const auto chosen = std::find_if(e.candidates.begin(), e.candidates.end(),
                                     [&](const Candidate& c) { return c.strategy == e.strategy; });
    std::string reason = strategy.name;
    if (chosen != e.candidates.end()) {
      if (chosen->value > 0) reason += ", relative value " + two_decimals(chosen->value);
      reason += ", relative cost " + two_decimals(chosen->cost);
    }
    // The component that a last resort adapts is not the cause.
    if (strategy.is_last_resort)
      return "as the last resort for " + listed(failures) + ": " + (e.dry_run ? "would " : "") +
             actions_of(strategy, rules_) + with + " (" + reason + ")";
    return listed(blamed) + (blamed.size() == 1 ? " is" : " are") + " held responsible for " +
           listed(failures) + doubt(e) + ": " + (e.dry_run ? "would " : "") +
           actions_of(strategy, rules_) + with + " (" + reason + ")";
  }
  std::string operator()(const FailureHeldBack& e) const {
    if (e.candidates.empty()) return "";
    // The reason why it waits: a strategy that was tried or is not possible would not be next in any
    // case, nor one in place of which another one waits. RoundSpent and RuleExhausted say that all were tried.
    const auto is_out = [](const Candidate& c) {
      return c.excluded == Condition::kTried || c.excluded == Condition::kInvalid ||
             c.excluded == Condition::kOneEach;
    };
    const auto waiting = std::find_if_not(e.candidates.begin(), e.candidates.end(), is_out);
    const auto impossible = std::ranges::find_if(e.candidates, [&](const Candidate& c) {
      return c.excluded == Condition::kInvalid && !rules_[c.strategy].is_last_resort;
    });
    if (waiting == e.candidates.end() && impossible == e.candidates.end()) return "";
    const Candidate& shown = waiting == e.candidates.end() ? *impossible : *waiting;
    if (shown.excluded == Condition::kWithheld) return "";  // ActionHeldBack says it
    return rules_[e.rule].name + " waits: " + describe_exclusion(shown, rules_);
  }
  std::string operator()(const AdaptationDone& e) const {
    const Adaptation& adaptation = rules_[e.strategy].adaptations[e.adaptation];
    return describe(adaptation, rules_) + ": done" +
           (e.remark.empty() ? "" : " (" + e.remark + ")");
  }
  std::string operator()(const AdaptationFailed& e) const {
    return describe(rules_[e.strategy].adaptations[e.adaptation], rules_) + ": failed, " + e.reason;
  }
  std::string operator()(const StrategyFailed& e) const {
    const Strategy& strategy = rules_[e.strategy];
    return strategy.name + " did not resolve " + rules_[strategy.rule].name + ": " + e.reason;
  }
  std::string operator()(const StrategyResumed& e) const {
    const Strategy& strategy = rules_[e.strategy];
    return strategy.name + " for " + rules_[strategy.rule].name +
           " was under way when culprit ended, and is finished now";
  }
  std::string operator()(const Undone& e) const {
    return e.succeeded ? e.what + " again" : "cannot be undone: " + e.what;
  }
  std::string operator()(const RoundSpent& e) const {
    const Rule& rule = rules_[e.rule];
    if (const auto only = only_last_resorts(rule); !only.empty()) return rule.name + " has " + only;
    return rule.name +
           ": each strategy has been tried lately; they are tried again after a back-off";
  }
  std::string operator()(const RuleExhausted& e) const {
    const Rule& rule = rules_[e.rule];
    if (rule.strategies.empty()) return rule.name + " only reports; a person must look";
    const std::string only = only_last_resorts(rule);
    return rule.name + " is exhausted: " +
           (only.empty() ? "nothing helped, a person must look"
                         : "it has " + only + ", and a person must look");
  }
  std::string operator()(const LastResortReached& e) const {
    return rules_[e.rule].name +
           ": no other strategy can begin or help in time, so its last resort is due";
  }
  std::string operator()(const LastResortDone& e) const {
    const Strategy& strategy = rules_[e.strategy];
    return strategy.name + " took effect; it stays while " + rules_[strategy.rule].name +
           " is there";
  }
  std::string operator()(const ComponentLost& e) const {
    return rules_[e.component].name + " is lost" +
           (rules_[e.component].is_required ? " and is REQUIRED" : "") +
           (e.remark.empty() ? "" : ": " + e.remark);
  }
  std::string operator()(const ComponentFound& e) const {
    return rules_[e.component].name + " is there" +
           (e.pid == 0 ? "" : " (process " + std::to_string(e.pid) + ")");
  }
  std::string operator()(const NeverSeen& e) const {
    const bool is_component = std::holds_alternative<ComponentId>(e.what);
    return std::visit([this](auto id) { return unseen(id); }, e.what) +
           (e.near.empty() ? "." : "; did you mean '" + e.near + "'?") +
           (is_component ? " culprit does not start it" : " Rules read it as unknown");
  }
  std::string operator()(const RuleBlind& e) const {
    return rules_[e.rule].name + " is blind: " + describe(e.blind);
  }
  std::string operator()(const RuleSees& e) const {
    return rules_[e.rule].name + " can be evaluated again after " +
           two_decimals(seconds(e.blind_for)) + " s";
  }
  std::string operator()(const LifecycleIntended&) const { return ""; }
  std::string operator()(const CameUp&) const { return ""; }
  std::string operator()(const IncidentOpened&) const { return ""; }
  std::string operator()(const IncidentChanged&) const { return ""; }
  std::string operator()(const IncidentClosed&) const { return ""; }
  std::string operator()(const RivalSeen& e) const {
    return "another program sets the mode of " + rules_[e.component].name +
           " back; culprit leaves it alone";
  }
  std::string operator()(const Trouble& e) const { return e.text; }
  std::string operator()(const OrderAccepted& e) const {
    return e.order.author + ": " + describe(e.order, rules_) +
           (e.order.reason.empty() ? "" : " (" + e.order.reason + ")") + held_back(e.holds_back);
  }
  std::string operator()(const OrderRefused& e) const {
    return e.order.author + " is refused: " + e.reason;
  }
  std::string operator()(const ActionHeldBack& e) const {
    return with_rule(e.strategy) + " is held back: " + e.reason;
  }
  std::string operator()(const ApprovalAsked& e) const {
    return with_rule(e.strategy) + " waits for approval: " + actions_of(rules_[e.strategy], rules_);
  }
  std::string operator()(const ApprovalLapsed& e) const {
    return with_rule(e.strategy) + " needs no approval any more";
  }
  std::string operator()(const StrategyAbandoned& e) const {
    return with_rule(e.strategy) + " is abandoned: " + e.reason;
  }
  std::string operator()(const OrderCarriedOut& e) const {
    return with_rule(e.strategy) + " was carried out";
  }
  std::string operator()(const OutcomePending&) const { return ""; }
  std::string operator()(const OutcomeCounted&) const { return ""; }
  std::string operator()(const FailureFlaps& e) const {
    return rules_[e.rule].name + " is flapping: detected " + std::to_string(e.times) +
           " times, and counted as one failure until it stays cleared";
  }
  std::string operator()(const SilenceEnded& e) const {
    return name_of(e.what) + " is no longer muted";
  }
  std::string operator()(const StormBegan& e) const {
    return "culprit starts no more strategies; a person must look: " + e.reason;
  }
  std::string operator()(const StormEnded&) const { return "culprit may start strategies again"; }
  std::string operator()(const JudgementSuspended& e) const {
    return "culprit judges nothing until it receives the robot's messages again: " + e.reason;
  }
  std::string operator()(const JudgementResumed&) const {
    return "culprit receives the robot's messages again; silent topics get a grace period";
  }
  std::string operator()(const SleepNoticed& e) const {
    return "culprit did not run for " + in_words(e.time) + "; silent topics get a grace period";
  }
  std::string operator()(const HostSilent& e) const {
    std::vector<std::string> names;
    for (const ComponentId c : e.components) names.push_back(rules_[c].name);
    return e.host + ", where " + listed(names) +
           " ran, is unreachable: it is down, or cut off. culprit starts nothing in their "
           "place until it is reachable again" +
           (e.is_last ? ". No other computer is reachable either: this one may be cut off" : "");
  }
  std::string operator()(const StaysDown& e) const {
    std::vector<std::string> names;
    for (const ComponentId each : e.components) names.push_back(rules_[each].name);
    const bool is_one = names.size() == 1;
    const std::string down = listed(names) + (is_one ? " stays down: " : " stay down: ");
    const std::string launcher = "process " + std::to_string(e.launcher);
    const std::string remedy = std::string("; start ") + (is_one ? "it" : "them") +
                               " again, or let culprit do it: culprit revive";
    switch (e.why) {
      case StaysDown::Why::kPerson:
        return down + "a person ended the launch of " + launcher + remedy;
      case StaysDown::Why::kDoubt:
        return down + "the launch of " + launcher + " ended " + in_words(e.after) + " after " +
               (e.fell ? rules_[*e.fell].name : "a component") +
               " crashed; a person may have ended it, or its on_exit=Shutdown()" + remedy +
               ". To start it again at once next time: culprit run --revive";
      case StaysDown::Why::kUnseen:
        return down +
               "the launch ended while culprit did not watch, so a person may have ended it" +
               remedy;
      case StaysDown::Why::kOwner:
        return down + "its owner ended it in an orderly way, as on a person's order" + remedy;
      case StaysDown::Why::kTerminal:
        return down + "it ended in the foreground of a terminal, as after Ctrl-C" + remedy;
      case StaysDown::Why::kShutDown:
        return down + "its node was shut down" + remedy;
      case StaysDown::Why::kStopped:
        return down + "a person stopped " + (is_one ? "it" : "them") +
               " in a terminal (Ctrl-Z); continue there (fg), or let culprit replace " +
               (is_one ? "it" : "them") + ": culprit revive";
      case StaysDown::Why::kFrozen:
        return down + "a person froze " + (is_one ? "it" : "them") +
               "; continue by systemctl thaw or docker unpause, or let culprit replace " +
               (is_one ? "it" : "them") + ": culprit revive";
      case StaysDown::Why::kUnloaded:
        return down + (is_one ? "it was" : "they were") +
               " unloaded, and not by culprit, and the container goes on; load " +
               (is_one ? "it" : "them") + " again, or let culprit do it: culprit revive";
      case StaysDown::Why::kOrder:
        return down + "a person ended the processes that culprit had started" + remedy;
    }
    return down;
  }
  std::string operator()(const HostBack& e) const { return e.host + " is reachable again"; }
  std::string operator()(const ValueUnknown& e) const {
    const Input& input = rules_[e.input];
    if (e.why == WhyUnknown::kOverflow) {
      return describe(input, rules_) + " is unknown: more than " +
             std::to_string(kMaxWindowSamples) +
             " samples come within its window. Shorten the window";
    }
    const bool is_signal = input.kind != Input::Kind::kParameter;
    return (is_signal ? rules_[input.signal].name : describe(input, rules_)) +
           " is not a number (NaN): rules read it as unknown" +
           (is_signal ? ", except isnan(" + rules_[input.signal].name + ")" : "");
  }
  std::string operator()(const PriorsAdopted& e) const {
    return (e.priors.size() == 1
                ? "the belief in 1 strategy begins"
                : "the beliefs in " + std::to_string(e.priors.size()) + " strategies begin") +
           " from the priors of " + (e.source.empty() ? "the rule file" : e.source);
  }

  std::string operator()(const Pause&) const { return "pause"; }
  std::string operator()(const Resume&) const { return "resume"; }
  std::string operator()(const SetDryRun& o) const {
    return o.is_on ? "dry run on" : "dry run off";
  }
  std::string operator()(const Approve& o) const { return with_rule(o.strategy) + " is approved"; }
  std::string operator()(const Refuse& o) const { return with_rule(o.strategy) + " is refused"; }
  std::string operator()(const Propose& o) const { return "propose " + with_rule(o.strategy); }
  std::string operator()(const Silence& o) const {
    return name_of(o.what) + " is muted" + (o.lasts ? " for " + in_words(*o.lasts) : "");
  }
  std::string operator()(const LiftSilence& o) const { return name_of(o.what) + " is unmuted"; }
  std::string operator()(const RunStrategy& o) const { return "run " + with_rule(o.strategy); }
  std::string operator()(const Revive&) const {
    return "start the components again that stay down";
  }
  std::string operator()(const EndStarted&) const {
    return "end the processes that culprit started";
  }
  std::string operator()(const Forget& o) const {
    return "forget the learned values of " + (o.rule ? name_of(*o.rule) : "all strategies");
  }

 private:
  // Strategies of different rules may have the same name. An order may name one that is not there.
  std::string with_rule(StrategyId id) const {
    if (id.index >= rules_.strategies.size()) return "an unknown strategy";
    return rules_[rules_[id].rule].name + "." + rules_[id].name;
  }
  std::string held_back(const std::vector<StrategyId>& last_resorts) const {
    if (last_resorts.empty()) return "";
    std::vector<std::string> names;
    for (const StrategyId id : last_resorts) names.push_back(with_rule(id));
    return last_resorts.size() == 1 ? "; this holds back the last resort " + names.front()
                                    : "; this holds back the last resorts " + listed(names);
  }
  // Empty: it has strategies that repair something, or none at all.
  std::string only_last_resorts(const Rule& rule) const {
    const auto is_last = [this](StrategyId s) { return rules_[s].is_last_resort; };
    if (rule.strategies.empty() || !std::ranges::all_of(rule.strategies, is_last)) return "";
    return rule.strategies.size() == 1 ? "no strategy besides its last resort"
                                       : "no strategies besides its last resorts";
  }
  std::string name_of(const Silenceable& what) const {
    if (const auto* rule = std::get_if<RuleId>(&what))
      return rule->index < rules_.rules.size() ? rules_[*rule].name : "an unknown rule";
    const ComponentId component = std::get<ComponentId>(what);
    return component.index < rules_.components.size() ? rules_[component].name
                                                      : "an unknown component";
  }

  std::string unseen(ComponentId id) const {
    const Component& component = rules_[id];
    return component.name + (component.is_required ? " is REQUIRED and" : "") +
           " was never seen: the robot has no node " +
           (component.node.empty() ? "called " + component.name : component.node);
  }
  std::string unseen(TopicId id) const {
    return rules_[id].name + " was never seen: no node publishes it";
  }
  std::string unseen(SignalId id) const {
    const Signal& signal = rules_[id];
    if (std::holds_alternative<GroupId>(signal.source))
      return "group " + signal.name + " was never seen: the state of some member was never read";
    const auto* key = std::get_if<DiagnosticKey>(&signal.source);
    const std::string source = key == nullptr || key->status == "*"
                                   ? "it"
                                   : "the key '" + key->key + "' of status '" + key->status + "'";
    return "signal " + signal.name + " was never seen: no message carries " + source;
  }
  std::string unseen(ParameterId id) const {
    const Parameter& parameter = rules_[id];
    return "parameter " + parameter.name + " of " + rules_[parameter.component].name +
           " was never seen: no value was read";
  }
  std::string unseen(DiagnosticId id) const {
    return "diagnostic " + rules_.diagnostics[id.index].name +
           " was never seen: no node publishes it";
  }

  // " (62 %; 38 %: fusion, by FusionDead)"; empty if nobody else is suspected.
  std::string doubt(const StrategyChosen& e) const {
    if (e.suspects.size() < 2) return "";
    std::string own;
    std::string others;
    for (const Suspect& suspect : e.suspects) {
      const std::string share = percents(suspect.probability);
      if (suspect.failure == rules_[e.strategy].rule) {
        own = share;
      } else {
        others += "; " + share + ": " + rules_[suspect.component].name + ", by " +
                  rules_[suspect.failure].name;
      }
    }
    return " (" + (own.empty() ? others.substr(2) : own + others) + ")";
  }

  const RuleSet& rules_;
};

}  // namespace

std::string two_decimals(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

std::string_view to_string(OutcomeCounted::As as) {
  switch (as) {
    case OutcomeCounted::As::kSuccess:
      return "success";
    case OutcomeCounted::As::kFailure:
      return "failure";
    case OutcomeCounted::As::kNothing:
      return "nothing";
  }
  return "";
}

namespace {

// The action whose status topic it is.
std::string action_of(const Topic& topic) {
  return topic.name.substr(0, topic.name.size() - kStatusOfAction.size());
}

}  // namespace

std::string describe(const Input& input, const RuleSet& rules) {
  const auto call = [&](std::string_view function, const std::string& subject) {
    const bool has_window = input.window > Duration::zero();
    return std::string(function) + "(" + subject +
           (has_window ? ", " + to_string(input.window) : "") + ")";
  };
  using enum Input::Kind;
  switch (input.kind) {
    case kSignal:
      return rules[input.signal].name;
    case kRate:
      return call("rate", rules.label(input.topic));
    case kAge:
      return call("age", rules.label(input.topic));
    case kPhi:
      return call("phi", rules.label(input.topic));
    case kLoss:
      return call("loss", rules.label(input.topic));
    case kAlive:
      return call("alive", rules[input.component].name);
    case kLifecycle:
      return call("lifecycle", rules[input.component].name);
    case kParameter: {
      const Parameter& parameter = rules[input.parameter];
      return call("parameter", rules[parameter.component].name + ", " + parameter.name);
    }
    case kLevel:
      return call("level", rules.diagnostics[input.diagnostic.index].name);
    case kMean:
      return call("mean", rules[input.signal].name);
    case kMin:
      return call("min", rules[input.signal].name);
    case kMax:
      return call("max", rules[input.signal].name);
    case kStddev:
      return call("stddev", rules[input.signal].name);
    case kChanged:
      return call("changed", rules[input.signal].name);
    case kFrozen:
      return call("frozen", rules[input.signal].name);
    case kGoals:
      return call("goals",
                  action_of(rules[input.topic]) + ", " + std::string(to_string(input.outcome)));
    case kGoalAge:
      return call("goal_age", action_of(rules[input.topic]));
    case kLogs:
      return call("logs",
                  rules[input.component].name + ", " + std::string(to_string(input.log_level)));
    case kCpu:
      return call("cpu", rules[input.component].name);
    case kMemory:
      return call("memory", rules[input.component].name);
    case kIsNan:
      return call("isnan", rules[input.signal].name);
  }
  return "";
}

std::string describe(const Departures::Departure& departure, const std::string& component) {
  const std::string launch = "the launch of process " + std::to_string(departure.launcher);
  switch (departure.why) {
    case StaysDown::Why::kPerson:
      return departure.launcher == 0 ? "a person ended the launch of " + component
                                     : "a person ended " + launch + ", " + component + " with it";
    case StaysDown::Why::kDoubt:
      return (departure.launcher == 0 ? "the launch of " + component : launch) +
             " ended soon after a crash; a person may have ended it";
    case StaysDown::Why::kUnseen:
      return "the launch of " + component +
             " ended while culprit did not watch; a person may have ended it";
    case StaysDown::Why::kOwner:
      return "the owner of " + component + " ended it in an orderly way, as on a person's order";
    case StaysDown::Why::kTerminal:
      return component + " ended in the foreground of a terminal, as after Ctrl-C";
    case StaysDown::Why::kShutDown:
      return "the node of " + component + " was shut down";
    case StaysDown::Why::kStopped:
      return "a person stopped " + component + " in a terminal (Ctrl-Z)";
    case StaysDown::Why::kFrozen:
      return "a person froze " + component + " (systemctl freeze, docker pause)";
    case StaysDown::Why::kUnloaded:
      return component + " was unloaded from its container, and not by culprit";
    case StaysDown::Why::kOrder:
      return "a person ended " + component + ", which culprit had started";
  }
  return component + " stays down";
}

std::string listed(const std::vector<std::string>& items) {
  std::string out;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) out += i + 1 == items.size() ? " and " : ", ";
    out += items[i];
  }
  return out;
}

std::vector<std::string> action_list(const Strategy& strategy, const RuleSet& rules) {
  std::vector<std::string> actions;
  for (const Adaptation& each : strategy.adaptations)
    actions.push_back((each.begins_step ? "then " : "") + describe(each, rules));
  return actions;
}

std::string actions_of(const Strategy& strategy, const RuleSet& rules) {
  const auto actions = action_list(strategy, rules);
  return strategy.has_steps() ? joined(actions) : listed(actions);
}

std::string to_string(Probability probability) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", 100 * probability.value);
  std::string number = text;
  if (number.ends_with(".0")) number.resize(number.size() - 2);
  return number + " %";
}

std::string_view to_string(Criticality criticality) {
  switch (criticality) {
    case Criticality::kNonCritical:
      return "NON_CRITICAL";
    case Criticality::kWarning:
      return "WARNING";
    case Criticality::kError:
      return "ERROR";
  }
  return "";
}

namespace {

// The owner that ends and starts it, where culprit does neither.
std::string owner_words(const Component& component) {
  using Engine = EngineContainer::Engine;
  const std::string where = component.host().empty() ? ")" : " on " + component.host() + ")";
  if (component.unit) return " (" + component.unit->name + where;
  if (component.engine)
    return std::string(component.engine->engine == Engine::kPodman ? " (podman " : " (docker ") +
           component.engine->name + where;
  if (component.composed) return " (in " + component.composed->container + ")";
  return component.is_respawned ? " (respawned)" : "";
}

}  // namespace

std::string describe(const Adaptation& adaptation, const RuleSet& rules) {
  const std::string& component = rules[adaptation.component].name;
  switch (adaptation.type) {
    case AdaptationType::kSetParameter:
      return "set " + adaptation.subject + " of " + component;
    case AdaptationType::kIncreaseParameter:
      return "increase " + adaptation.subject + " of " + component;
    case AdaptationType::kDecreaseParameter:
      return "decrease " + adaptation.subject + " of " + component;
    case AdaptationType::kChangeCommunication:
      return "let " + component + " use " + adaptation.topic + " as " + adaptation.subject;
    case AdaptationType::kChangeMode:
      return "change " + component + " to mode " + adaptation.subject;
    case AdaptationType::kCall:
      return "call " + adaptation.subject + " of " + component +
             (adaptation.request.empty() ? "" : " with " + adaptation.request);
    case AdaptationType::kRedeploy:
    case AdaptationType::kStart:
    case AdaptationType::kStop:
      return std::string(keyword(adaptation.type)) + " " + component +
             owner_words(rules[adaptation.component]);
    case AdaptationType::kActivate:
    case AdaptationType::kDeactivate:
    case AdaptationType::kRestart:
    case AdaptationType::kStartGroup:
      break;
  }
  return std::string(keyword(adaptation.type)) + " " + component;
}

std::string describe(const Order& order, const RuleSet& rules) {
  return std::visit(Describer(rules), order.what);
}

std::string describe(const Event& event, const RuleSet& rules) {
  return escape_controls(std::visit(Describer(rules), event.what));
}

}  // namespace culprit
