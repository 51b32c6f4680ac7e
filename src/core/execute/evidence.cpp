#include "execute/evidence.h"

#include <algorithm>

#include "diagnose/blameless.h"
#include "execute/goal.h"
#include "execute/limits.h"

namespace culprit::execute {
namespace {

constexpr Duration kOverdue = std::chrono::milliseconds(450);  // it is asked every 400 ms

// The topics that the rule reads, if it reads only ages, rates and what is alive; empty otherwise.
std::optional<std::vector<TopicId>> silent_topics(const Rule& rule, const RuleSet& rules) {
  std::vector<TopicId> topics;
  for (const InputId id : rule.inputs) {
    const Input& input = rules[id];
    switch (input.kind) {
      case Input::Kind::kRate:
      case Input::Kind::kAge:
      case Input::Kind::kPhi:
        topics.push_back(input.topic);
        break;
      case Input::Kind::kAlive:
        break;
      default:
        return std::nullopt;
    }
  }
  return topics;
}

bool is_at_work(const ComponentState& state) {
  return state.known_pid() != 0 && state.process == ProcessState::kRunning && state.in_graph &&
         state.alive == true;
}

// Since when a topic that the rule reads, and that only the component publishes, does not come any more.
std::optional<Time> silent_since(ComponentId component, const Rule& rule,
                                 const Knowledge& knowledge, Time now) {
  std::optional<Time> since;
  for (const InputId id : rule.inputs) {
    const Input& input = knowledge.rules[id];
    const bool is_of_topic = input.kind == Input::Kind::kRate || input.kind == Input::Kind::kAge ||
                             input.kind == Input::Kind::kPhi;
    if (!is_of_topic) continue;
    const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(input.topic);
    const Topic& topic = knowledge.rules[input.topic];
    const bool is_its =
        knowledge.graph.publishes(component, topic) && knowledge.graph.publisher_count(topic) == 1;
    const bool is_known = rhythm.last && rhythm.interval > Duration::zero();
    if (is_its && is_known &&
        later(rhythm.silent_since(), rhythm.interval + rhythm.interval / 2) < now)
      since = std::max(since.value_or(kLongAgo), *rhythm.last);
  }
  return since;
}

// One of those that the strategy disturbs, if none of them is to blame for the failure.
std::optional<ComponentId> blameless_component(const Strategy& strategy,
                                               const Knowledge& knowledge) {
  std::optional<ComponentId> first;
  for (const Adaptation& adaptation : strategy.adaptations) {
    if (adaptation.type != AdaptationType::kRestart && adaptation.type != AdaptationType::kRedeploy)
      continue;
    if (!diagnose::is_blameless(adaptation.component, strategy.rule, knowledge))
      return std::nullopt;
    if (!first) first = adaptation.component;
  }
  return first;
}

}  // namespace

std::optional<std::string> contradiction(const Strategy& strategy, const Knowledge& knowledge,
                                         Time now) {
  const RuleSet& rules = knowledge.rules;
  if (const auto blameless = blameless_component(strategy, knowledge))
    return rules[*blameless].name + " is well: something else is the reason of " +
           rules[strategy.rule].name;
  const auto silent = silent_topics(rules[strategy.rule], rules);
  if (!silent) return std::nullopt;
  for (const Adaptation& adaptation : strategy.adaptations) {
    const ComponentId component = adaptation.component;
    if (adaptation.type != AdaptationType::kRedeploy ||
        !is_at_work(knowledge.components[component]))
      continue;
    // Its own outage, one of what a DEPENDENCY says it carries, or one without any publisher, speaks against it.
    const auto carries = [&](ComponentId consumer) {
      return std::ranges::any_of(rules.dependencies, [&](const Dependency& d) {
        return d.producer == component && d.consumer == consumer;
      });
    };
    const bool is_suspect = std::any_of(silent->begin(), silent->end(), [&](TopicId topic) {
      const auto publisher = knowledge.graph.only_publisher(rules[topic]);
      return knowledge.graph.publishes(component, rules[topic]) ||
             knowledge.graph.publisher_count(rules[topic]) == 0 ||
             (publisher && carries(*publisher));
    });
    const auto heard = is_suspect ? std::nullopt : knowledge.heard_topic(component, now);
    if (heard)
      return rules[component].name + " runs and publishes " + rules.label(*heard) +
             "; it does not publish the silent topic";
  }
  return std::nullopt;
}

bool owes_answer(const ComponentState& state, Time now) {
  return state.answers_probes && later(state.answered, kOverdue) < now;
}

std::optional<AnswerToCome> answer_to_come(const Strategy& strategy, const Knowledge& knowledge,
                                           Time now) {
  // Two or three unanswered probes, 500 ms each, show that it hangs (Monitor).
  constexpr Duration kVerdict = std::chrono::milliseconds(1900);
  // Less than it takes to be asked again.
  constexpr Duration kWakes = std::chrono::milliseconds(250);
  for (const Adaptation& adaptation : strategy.adaptations) {
    const bool disturbs =
        adaptation.type == AdaptationType::kRestart || adaptation.type == AdaptationType::kRedeploy;
    const ComponentState& state = knowledge.components[adaptation.component];
    const bool is_asked = is_at_work(state) && state.changes_until == kNever;
    if (!disturbs || !is_asked || !state.answers_probes) continue;
    const auto silent =
        silent_since(adaptation.component, knowledge.rules[strategy.rule], knowledge, now);
    Duration patience{};
    // A component that has just answered may have been busy: its thread works again, and publishes
    // next.
    if (silent) patience = kWakes;
    if (owes_answer(state, now) || (silent && state.answered <= *silent)) patience = kVerdict;
    const Time until = later(state.answered, patience);
    if (now < until)
      return AnswerToCome{
          "culprit checks whether " + knowledge.rules[adaptation.component].name + " still answers",
          until};
  }
  return std::nullopt;
}

std::optional<AnswerToCome> driver_to_come(const Strategy& strategy, const Knowledge& knowledge,
                                           Time now) {
  constexpr Duration kSpeaks =
      std::chrono::seconds(1);  // from its activation to its first messages
  if (knowledge.finding <= Duration::zero()) return std::nullopt;
  for (const Adaptation& adaptation : strategy.adaptations) {
    const ComponentState& state = knowledge.components[adaptation.component];
    const Component& component = knowledge.rules[adaptation.component];
    const bool disturbs = (adaptation.type == AdaptationType::kActivate && !adaptation.group) ||
                          adaptation.type == AdaptationType::kRestart ||
                          adaptation.type == AdaptationType::kRedeploy;
    if (!disturbs || state.alive != true || component.lifecycle == LifecycleDriver::kManaged)
      continue;
    Time until = later(state.node_seen, grace_of_driver(adaptation, knowledge));
    const bool is_up = state.lifecycle == Lifecycle::kActive;
    if (is_up) until = std::min(until, later(state.lifecycle_since, kSpeaks));
    if ((state.is_rising || is_up) && now < until)
      return AnswerToCome{
          component.name + " has just started and was activated without culprit the last time",
          until};
  }
  return std::nullopt;
}

std::optional<std::string> launch_of_the_unseen(const Strategy& strategy,
                                                const Knowledge& knowledge) {
  for (const Adaptation& adaptation : strategy.adaptations) {
    const ComponentId component = adaptation.component;
    if (launches(adaptation) && !knowledge.discovered.has(component))
      return knowledge.rules[component].name +
             " was never seen; run --launch starts what is not there";
  }
  return std::nullopt;
}

std::optional<std::string> doubt_of_identity(const Strategy& strategy, const Knowledge& knowledge) {
  for (const ComponentId component : strategy.components) {
    const ComponentState& state = knowledge.components[component];
    if (state.in_graph && state.namesakes > 0)
      return "several nodes have the name " + knowledge.graph.node_name(component);
  }
  return std::nullopt;
}

}  // namespace culprit::execute
