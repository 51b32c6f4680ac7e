#include "diagnose/paths.h"

#include <algorithm>
#include <cmath>

#include "diagnose/touched.h"

namespace culprit::diagnose {
namespace {

using Vertex = DependencyGraph::Vertex;

// The quiet rules and the failures of a component, by symptom.
struct Signs {
  std::array<bool, 2> is_watched{};    // by a quiet rule of each kind
  std::array<bool, 2> has_ill{};       // a rule of that kind is not quiet, or imminent
  std::array<Duration, 2> fires_in{};  // after an onset, the quiet rules of that kind
  std::array<Time, 2> ill_since{kLongAgo, kLongAgo};  // the latest onset of what is ill
  bool may_end_data = false;  // its bad values may end what its consumers send, though they arrive

  // Bad values come of outages too, but no outages of bad values.
  bool is_ill(Symptom symptom) const {
    return has_ill[static_cast<std::size_t>(Symptom::kOutage)] ||
           has_ill[static_cast<std::size_t>(symptom)];
  }
  Time ill_from(Symptom symptom) const {
    return std::max(ill_since[static_cast<std::size_t>(Symptom::kOutage)],
                    ill_since[static_cast<std::size_t>(symptom)]);
  }
  bool is_well(Symptom symptom) const {
    return !is_ill(symptom) && !may_end_data && is_watched[static_cast<std::size_t>(symptom)];
  }
};

// Is its failure there, or at least its trigger true: in its COOLDOWN, or after ON_CHANGE?
bool is_ill(const RuleState& state) {
  const Detection& seen = state.detection;
  return state.phase != RulePhase::kQuiet ||
         (seen.history.empty() && seen.trigger.known && seen.trigger.b);
}

// Was each topic of a quiet rule received since culprit can receive again? Until then the rule
// gives no evidence.
bool has_heard(RuleId rule, const Knowledge& knowledge) {
  const auto& inputs = knowledge.rules[rule].inputs;
  return std::all_of(inputs.begin(), inputs.end(), [&](InputId id) {
    const Input& input = knowledge.rules[id];
    const bool is_heard = input.kind == Input::Kind::kAge || input.kind == Input::Kind::kPhi ||
                          input.kind == Input::Kind::kRate;
    if (!is_heard) return true;
    const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(input.topic);
    return !rhythm.last || rhythm.resumed <= *rhythm.last;
  });
}

// May the failing values of the rule end the data of the component's consumers? Not if the rule has ON_CHANGE: the robot is
// in another state of its mission. A rule that only reconfigures finds nothing broken; then a DEPENDENCY must name the supplier.
bool may_end_data(RuleId id, ComponentId component, const RuleSet& rules) {
  const Rule& rule = rules[id];
  if (rule.policies.on_change) return false;
  return is_mended(id, rules) ||
         std::ranges::find(rules.dependencies, component, &Dependency::producer) !=
             rules.dependencies.end();
}

// No age shows that a topic has become slow. One that is sent on demand may come late and mean nothing.
void add_slow_topics(const Knowledge& knowledge, std::vector<Signs>& signs) {
  const auto outage = static_cast<std::size_t>(Symptom::kOutage);
  for (std::size_t t = 0; t < knowledge.rules.topics.size(); ++t) {
    const auto& rhythm = knowledge.signals.rhythm(TopicId(t));
    if (!rhythm.slowing || !rhythm.is_steady()) continue;
    const auto publisher = knowledge.graph.only_publisher(knowledge.rules[TopicId(t)]);
    if (!publisher) continue;
    Signs& of = signs[publisher->index];
    of.has_ill[outage] = true;
    of.ill_since[outage] = std::max(of.ill_since[outage], rhythm.slowing->since);
  }
}

std::vector<Signs> signs_of(const Knowledge& knowledge, std::span<const RuleId> imminent,
                            std::span<const std::optional<TroubleSeen>> troubles) {
  std::vector<Signs> signs(knowledge.rules.components.size());
  const auto add_ill = [&](RuleId rule, Time since) {
    const auto symptom = static_cast<std::size_t>(symptom_of(rule, knowledge));
    for (const ComponentId c : spreads_from(rule, knowledge)) {
      signs[c.index].has_ill[symptom] = true;
      signs[c.index].ill_since[symptom] = std::max(signs[c.index].ill_since[symptom], since);
      if (symptom == static_cast<std::size_t>(Symptom::kValue))
        signs[c.index].may_end_data |= may_end_data(rule, c, knowledge.rules);
    }
  };
  const auto add_quiet = [&](RuleId rule) {
    if (knowledge.rules[rule].components.empty()) return;  // a quiet report proves no health
    if (knowledge.states[rule].detection.last_false == kLongAgo)
      return;  // it cannot have fired yet
    const auto symptom = static_cast<std::size_t>(symptom_of(rule, knowledge));
    const Duration fires_in = evidence_within(rule, knowledge.now, knowledge);
    for (const ComponentId c : touched_by(rule, knowledge)) {
      Duration& longest = signs[c.index].fires_in[symptom];
      signs[c.index].is_watched[symptom] = true;
      longest = std::max(longest, fires_in);
    }
  };
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    const RuleState& state = knowledge.states[RuleId(r)];
    const bool is_seen_ill = is_ill(state);
    const bool sees = state.detection.trigger.known && tells_of_data(RuleId(r), knowledge.rules) &&
                      has_heard(RuleId(r), knowledge);
    if (is_seen_ill)
      add_ill(RuleId(r), state.phase == RulePhase::kQuiet
                             ? onset_now(RuleId(r), knowledge.now, knowledge).latest
                             : onset_of(RuleId(r), knowledge).latest);
    else if (sees)
      add_quiet(RuleId(r));
  }
  for (const RuleId rule : imminent)
    add_ill(rule, onset_now(rule, knowledge.now, knowledge).latest);
  add_slow_topics(knowledge, signs);
  const auto outage = static_cast<std::size_t>(Symptom::kOutage);
  for (std::size_t c = 0; c < signs.size(); ++c) {
    if (!troubles[c]) continue;
    signs[c].has_ill[outage] = true;
    signs[c].ill_since[outage] = std::max(signs[c].ill_since[outage], troubles[c]->onset.latest);
  }
  return signs;
}

// Are so many of the consumers well only by chance, if most of them would be ill?
bool can_carry(std::size_t well, std::size_t ill) {
  const auto all = static_cast<double>(well + ill);
  return static_cast<double>(well) <=
         kSpared * all + kDeviations * std::sqrt(kSpared * (1 - kSpared) * all);
}

class Narrowing {
 public:
  Narrowing(const Knowledge& knowledge, const std::vector<Signs>& signs, Symptom symptom)
      : knowledge_(knowledge),
        place_(knowledge.graph.size(), 0),
        is_ill_(knowledge.graph.size(), false),
        ill_since_(knowledge.graph.size(), kLongAgo),
        shows_within_(knowledge.graph.size()) {
    const Duration passing = duration_of(kPassing, knowledge.rules);
    for (std::size_t c = 0; c < signs.size(); ++c) {
      const auto vertex = knowledge.graph.vertex_of(ComponentId(c));
      if (!vertex) continue;
      is_ill_[*vertex] = signs[c].is_ill(symptom);
      ill_since_[*vertex] = signs[c].ill_from(symptom);
      shows_within_[*vertex] = passing + signs[c].fires_in[static_cast<std::size_t>(symptom)];
      if (signs[c].is_well(symptom)) place_[*vertex] = kOut;
    }
    for (Vertex& place : place_) {
      if (place != kOut) place = left_++;
    }
  }

  Reach reach(const Reach& whole) const {
    ChannelEdges edges(left_);
    std::vector<Vertex> producers;
    std::vector<Vertex> consumers;
    knowledge_.graph.for_each_channel(
        [&](std::span<const Vertex> from, std::span<const Vertex> to) {
          producers.clear();
          for (const Vertex v : from) {
            if (place_[v] != kOut) producers.push_back(place_[v]);
          }
          if (producers.empty()) return;
          consumers.clear();
          std::size_t ill = 0;
          std::size_t well = 0;
          // If no rule watches the producers, their effects tell when it began.
          const Time known = latest_onset(from);
          const Time since = known == kLongAgo ? latest_onset(to) : known;
          for (const Vertex v : to) {
            if (place_[v] != kOut) consumers.push_back(place_[v]);
            ill += is_ill_[v] ? 1 : 0;
            well += place_[v] == kOut && has_shown(v, since) ? 1 : 0;
          }
          if (!consumers.empty() && can_carry(well, ill)) edges.add(producers, consumers);
        });
    const Condensation graph(edges.vertices(), edges.edges());
    Reach::Sccs sccs(knowledge_.rules.components.size());
    for (std::size_t c = 0; c < sccs.size(); ++c) {
      const auto vertex = knowledge_.graph.vertex_of(ComponentId(c));
      if (vertex && place_[*vertex] != kOut) sccs[c] = graph.scc_of(place_[*vertex]);
    }
    std::vector<ComponentId> components;
    for (std::size_t p = 0; p < whole.size(); ++p) components.push_back(whole[p]);
    return {graph, sccs, std::move(components)};
  }

 private:
  static constexpr Vertex kOut = static_cast<Vertex>(-1);

  Time latest_onset(std::span<const Vertex> vertices) const {
    Time latest = kLongAgo;
    for (const Vertex v : vertices) latest = std::max(latest, ill_since_[v]);
    return latest;
  }
  // Would it fail by now, if a failure of `since` then had reached it?
  bool has_shown(Vertex consumer, Time since) const {
    return knowledge_.now >= later(since, shows_within_[consumer]);
  }

  const Knowledge& knowledge_;
  std::vector<Vertex> place_;  // among what is left
  std::vector<bool> is_ill_;
  std::vector<Time> ill_since_;
  std::vector<Duration> shows_within_;
  Vertex left_ = 0;
};

}  // namespace

Paths::Paths(const Knowledge& knowledge, const Reach& whole, const Awaited& awaited,
             std::span<const RuleId> imminent, std::span<const std::optional<TroubleSeen>> troubles)
    : knowledge_(knowledge), whole_(whole), awaited_(awaited) {
  std::array<bool, 2> is_needed{};
  for (const RuleId rule : knowledge.states.active()) {
    if (!has_whole_graph(rule))
      is_needed[static_cast<std::size_t>(symptom_of(rule, knowledge))] = true;
  }
  if (!is_needed[0] && !is_needed[1]) return;
  const std::vector<Signs> signs = signs_of(knowledge, imminent, troubles);
  for (const Symptom symptom : {Symptom::kOutage, Symptom::kValue}) {
    const bool is_any_well =
        std::any_of(signs.begin(), signs.end(), [&](const Signs& s) { return s.is_well(symptom); });
    const auto kind = static_cast<std::size_t>(symptom);
    if (is_needed[kind] && is_any_well)
      narrowed_[kind] = Narrowing(knowledge, signs, symptom).reach(whole);
  }
}

bool Paths::has_whole_graph(RuleId rule) const {
  const auto awaiting = awaited_.of(rule);
  return awaiting && !awaiting->is_echo;
}

std::span<const Word> Paths::upstream(std::size_t place, RuleId rule) const {
  const auto& narrowed = narrowed_[static_cast<std::size_t>(symptom_of(rule, knowledge_))];
  return (narrowed && !has_whole_graph(rule) ? *narrowed : whole_).upstream(place);
}

}  // namespace culprit::diagnose
