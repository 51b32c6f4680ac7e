#include "diagnose/questions.h"

#include <algorithm>
#include <iterator>

namespace culprit::diagnose {
namespace {

using Vertex = DependencyGraph::Vertex;

bool is_open(const ComponentState& state, Time now) {
  return state.questioned.is_open && now < later(state.questioned.at, kLongestQuestion);
}

bool has_answered(const ComponentState& state) {
  return state.questioned.at != kLongAgo && state.answered >= state.questioned.at;
}

// One that answered may have hung right afterwards.
bool may_be_asked_again(const ComponentState& state, Time now) {
  const Duration pause = has_answered(state) ? kLongestQuestion : kAskedAgain;
  return !is_open(state, now) && now >= later(state.questioned.at, pause);
}

// As may_be_asked_again(), but for the second question after a first one in vain.
bool may_be_asked_at_once(const ComponentState& state, Time now) {
  const Questioned& questioned = state.questioned;
  const bool is_second = questioned.unanswered == questioned.at && !questioned.is_open;
  return is_second || may_be_asked_again(state, now);
}

// When each component proved last that it works: it joined the graph, it answered, or a message came
// on a topic that it alone publishes.
std::vector<Time> last_signs(const Knowledge& knowledge) {
  std::vector<Time> signs = published_last(knowledge);
  for (std::size_t c = 0; c < signs.size(); ++c) {
    const ComponentState& state = knowledge.components[ComponentId(c)];
    signs[c] = std::max({signs[c], state.answered, state.node_seen});
  }
  return signs;
}

// Could it answer a probe? Not if it is known to be dead, lost, or on an unreachable computer.
bool can_be_asked(ComponentId component, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[component];
  return knowledge.discovered.has(component) && state.in_graph &&
         state.process == ProcessState::kRunning && state.alive != false &&
         state.lifecycle != Lifecycle::kTransition && !state.questioned.is_pointless &&
         !knowledge.is_unheard(component);
}

// How many channels lie between each node and the nearest one of `from`, upstream of it.
std::vector<std::size_t> distances_to(const std::vector<ComponentId>& from,
                                      const Knowledge& knowledge) {
  const std::size_t far = knowledge.graph.size();
  std::vector<std::size_t> distances(far, far);
  for (const ComponentId c : from) {
    if (const auto vertex = knowledge.graph.vertex_of(c)) distances[*vertex] = 0;
  }
  bool goes_on = true;
  for (std::size_t distance = 1; goes_on && distance < far; ++distance) {
    goes_on = false;
    knowledge.graph.for_each_channel(
        [&](std::span<const Vertex> producers, std::span<const Vertex> consumers) {
          const bool is_next = std::any_of(consumers.begin(), consumers.end(),
                                           [&](Vertex v) { return distances[v] == distance - 1; });
          for (const Vertex v : producers) {
            if (!is_next || distances[v] != far) continue;
            distances[v] = distance;
            goes_on = true;
          }
        });
  }
  return distances;
}

void keep_nearest(std::vector<ComponentId>& components, RuleId failure,
                  const Knowledge& knowledge) {
  if (components.size() > kMostQuestions) {
    const auto distances = distances_to(knowledge.rules[failure].components, knowledge);
    std::stable_sort(components.begin(), components.end(), [&](ComponentId a, ComponentId b) {
      return distances[*knowledge.graph.vertex_of(a)] < distances[*knowledge.graph.vertex_of(b)];
    });
    components.resize(kMostQuestions);
  }
}

std::size_t open_questions(const Knowledge& knowledge) {
  std::size_t open = 0;
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c)
    open += is_open(knowledge.components[ComponentId(c)], knowledge.now) ? 1 : 0;
  return open;
}

}  // namespace

Questioner::Questioner(const Knowledge& knowledge,
                       std::span<const std::optional<TroubleSeen>> troubles)
    : knowledge_(knowledge), troubles_(troubles), open_(open_questions(knowledge)) {}

// Asks the silent ones, as far as that is allowed now. One that has to wait for room is awaited, too: open questions end
// within kLongestQuestion.
void Questioner::ask(std::span<const ComponentId> silent, IsAllowed is_allowed,
                     Questions& questions) {
  for (const ComponentId c : silent) {
    const ComponentState& state = knowledge_.components[c];
    bool is_asked = std::ranges::find(asked_, c) != asked_.end();
    const bool is_due = !is_asked && is_allowed(state, knowledge_.now);
    if (is_due && open_ < kMostQuestions) {
      asked_.push_back(c);
      ++open_;
      is_asked = true;
    }
    if (is_asked) questions.asks.push_back(c);
    const bool is_awaited = is_asked || is_due || is_open(state, knowledge_.now);
    if (!questions.awaited && is_awaited) questions.awaited = c;
  }
}

// The publisher of messages that are lost is asked, whether it is upstream of the failure or its cause.
void Questioner::ask_publisher(const Lost& lost, RuleId failure, Questions& questions) {
  const ComponentState& state = knowledge_.components[lost.publisher];
  // It is not asked again within kAskedAgain, so an answer counts for that long.
  if (later(state.answered, kAskedAgain) >= knowledge_.states[failure].failing_since)
    questions.lost = lost;
  else
    ask({&lost.publisher, 1}, may_be_asked_again, questions);
}

void Questioner::look() {
  if (!last_signs_.empty()) return;
  last_signs_ = last_signs(knowledge_);
  for (std::size_t c = 0; c < last_signs_.size(); ++c) {
    if (may_hang(ComponentId(c))) oldest_sign_ = std::min(oldest_sign_, last_signs_[c]);
  }
}

// Only its answer tells whether a silent one hangs, or is an effect.
bool Questioner::may_hang(ComponentId component) const {
  const auto& trouble = troubles_[component.index];
  const bool is_known = trouble && trouble->trouble != Trouble::kSilent;
  return !is_known && can_be_asked(component, knowledge_);
}

// Upstream of all that its rule adapts, and what the rule adapts itself upstream of the strategy.
std::vector<ComponentId> Questioner::suppliers(const Strategy& strategy) const {
  const std::vector<ComponentId>& adapted = knowledge_.rules[strategy.rule].components;
  std::vector<ComponentId> all = knowledge_.graph.upstream(adapted);
  if (adapted.size() == strategy.components.size()) return all;
  const auto& upstream = knowledge_.graph.upstream(strategy.components);
  std::ranges::copy_if(upstream, std::back_inserter(all),
                       [&](ComponentId c) { return std::ranges::find(all, c) == all.end(); });
  return all;
}

// The failure may show something that began after its first cause was repaired.
Time Questioner::shows_since(RuleId failure) const {
  const RuleState& state = knowledge_.states[failure];
  const Time onset = onset_of(failure, knowledge_).latest;
  return later(std::max({onset, state.masked_until, state.unhelped_at}), kProvesHealth);
}

Questions Questioner::about(const Strategy& strategy) {
  const RuleId failure = strategy.rule;
  Questions questions;
  const auto lost = lost_behind(failure, knowledge_);
  if (lost && !troubles_[lost->publisher.index] && can_be_asked(lost->publisher, knowledge_)) {
    ask_publisher(*lost, failure, questions);
    if (questions.lost || questions.awaited) return questions;
  }
  const Time begun = shows_since(failure);
  look();
  if (oldest_sign_ >= begun) return questions;
  std::vector<ComponentId> silent;
  for (const ComponentId c : suppliers(strategy)) {
    if (last_signs_[c.index] < begun && may_hang(c)) silent.push_back(c);
  }
  std::sort(silent.begin(), silent.end(), [&](ComponentId a, ComponentId b) {
    return knowledge_.rules[a].name < knowledge_.rules[b].name;
  });
  keep_nearest(silent, failure, knowledge_);
  ask(silent, may_be_asked_again, questions);
  return questions;
}

Questions Questioner::to(std::span<const ComponentId> components, RuleId failure) {
  Questions questions;
  std::vector<ComponentId> silent;
  const Time begun = shows_since(failure);
  for (const ComponentId c : components) {
    const ComponentState& state = knowledge_.components[c];
    if (!state.answers_probes || state.answered >= begun || answers_no_question(state) ||
        !can_be_asked(c, knowledge_))
      continue;
    look();
    if (last_signs_[c.index] < begun) silent.push_back(c);
  }
  ask(silent, may_be_asked_at_once, questions);
  return questions;
}

// The second question is asked at once, so a later one that is open is a third.
bool answers_no_question(const ComponentState& state) {
  const Questioned& questioned = state.questioned;
  if (!state.answers_probes || !questioned.unanswered || questioned.is_pointless) return false;
  const Time second = later(*questioned.unanswered, 2 * kLongestQuestion);
  return questioned.at > (questioned.is_open ? second : *questioned.unanswered);
}

bool is_overdue(ComponentId component, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[component];
  const auto& asked = state.questioned.unanswered;
  return asked && state.answers_probes && can_be_asked(component, knowledge) &&
         last_signs(knowledge)[component.index] < *asked;
}

bool is_to_be_asked_again(ComponentId component, const Knowledge& knowledge) {
  return is_overdue(component, knowledge) &&
         may_be_asked_again(knowledge.components[component], knowledge.now);
}

bool is_to_be_asked(ComponentId component, const TroubleSeen& trouble, const Knowledge& knowledge) {
  return (trouble.is_of_values() && can_be_asked(component, knowledge) &&
          may_be_asked_again(knowledge.components[component], knowledge.now)) ||
         is_to_be_asked_again(component, knowledge);
}

}  // namespace culprit::diagnose
