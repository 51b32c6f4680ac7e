#include "diagnose/causes.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/invariant.h"
#include "diagnose/awaited.h"
#include "diagnose/imminent.h"
#include "diagnose/known_down.h"
#include "diagnose/senders.h"
#include "diagnose/touched.h"
#include "diagnose/unclear.h"

namespace culprit::diagnose {
namespace {

void sort_by_name(std::vector<RuleId>& ids, const RuleSet& rules) {
  std::sort(ids.begin(), ids.end(),
            [&](RuleId a, RuleId b) { return rules[a].name < rules[b].name; });
}

// Visits what can be reached from `root` through `rows` and is still in `open`, which it leaves.
// Calls `done` for each when all that it leads to was visited.
template <class Done>
void search(std::size_t root, const BitRows& rows, std::span<Word> open,
            std::vector<std::size_t>& path, Done done) {
  clear(open, root);
  path.assign(1, root);
  while (!path.empty()) {
    const auto next = first_common(rows[path.back()], open);
    if (!next) {
      done(path.back());
      path.pop_back();
      continue;
    }
    clear(open, *next);
    path.push_back(*next);
  }
}

bool contains(std::span<const ComponentId> all, ComponentId component) {
  return std::ranges::find(all, component) != all.end();
}

std::size_t level_of(const Rule& rule) {
  return static_cast<std::size_t>(rule.policies.criticality);
}

// Does a strategy of its rule do more than to reconfigure?
bool may_be_broken(RuleId rule, const RuleSet& rules) {
  return std::ranges::any_of(rules[rule].strategies, [&](StrategyId s) { return mends(rules[s]); });
}

// The latest onset of the first of its troubles that followed one another, this one included.
Time troubled_since(ComponentId component, const TroubleSeen& seen, const Knowledge& knowledge) {
  const auto& past = knowledge.components[component].past_trouble;
  const bool was_before = past && seen.onset.latest <= later(past->over, kLongestEvidence);
  return was_before ? std::min(seen.first_onset, past->since) : seen.first_onset;
}

// As a cause, a flapping failure began with its first detection; as an effect, with its last.
Onset onset_of_node(RuleId failure, const Knowledge& knowledge) {
  const Onset onset = onset_of(failure, knowledge);
  return {std::min(onset.earliest, first_onset_of(failure, knowledge)), onset.latest};
}

// Does the rule change modes, or is it about a lifecycle? One that reads the lifecycle of a component
// that is active is about something else.
bool is_about_states(RuleId rule, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  const auto& inputs = rules[rule].inputs;
  const bool reads_lifecycle = std::any_of(inputs.begin(), inputs.end(), [&](InputId id) {
    return rules[id].kind == Input::Kind::kLifecycle &&
           knowledge.components[rules[id].component].lifecycle != Lifecycle::kActive;
  });
  const auto changes_mode = [](const Adaptation& a) {
    return a.type == AdaptationType::kChangeMode;
  };
  return reads_lifecycle ||
         std::any_of(rules[rule].strategies.begin(), rules[rule].strategies.end(),
                     [&](StrategyId s) {
                       return std::any_of(rules[s].adaptations.begin(), rules[s].adaptations.end(),
                                          changes_mode);
                     });
}

// Does the rule watch nothing but what `other` watches, too?
bool watches_the_same(RuleId rule, RuleId other, const RuleSet& rules) {
  return std::ranges::all_of(rules[rule].inputs, [&](InputId id) {
    return std::ranges::any_of(rules[other].inputs, [&](InputId same) {
      const bool are_of_topics = watches_a_topic(rules[id]) && watches_a_topic(rules[same]);
      return id == same || (are_of_topics && rules[id].topic == rules[same].topic);
    });
  });
}

bool is_left_to_person(RuleId rule, const Knowledge& knowledge) {
  return knowledge.rules[rule].strategies.empty() || knowledge.states.awaits_person(rule);
}

bool is_replaced_by(RuleId rule, ComponentId component, const RuleSet& rules) {
  return std::ranges::any_of(rules[rule].strategies, [&](StrategyId id) {
    return !rules[id].is_last_resort && replaces(rules[id], component);
  });
}

// Is rule j left to a person, though another one mends all that it is about (`mended`)? Not if j has replaced that itself,
// in vain.
bool is_left_to(RuleId j, std::span<const ComponentId> mended, const Knowledge& knowledge) {
  const std::vector<ComponentId> about = touched_by(j, knowledge);
  return !about.empty() && is_left_to_person(j, knowledge) &&
         std::ranges::all_of(about, [&](ComponentId c) {
           return contains(mended, c) && !is_replaced_by(j, c, knowledge.rules);
         });
}

// Is rule j, which its COOLDOWN holds back, about what i is about, too (`touched`)? Then i repairs it.
bool is_same_in_cooldown(RuleId j, std::span<const ComponentId> touched,
                         const Knowledge& knowledge) {
  return is_held_by_cooldown(j, knowledge) &&
         std::ranges::any_of(touched_by(j, knowledge),
                             [&](ComponentId c) { return contains(touched, c); });
}

// Is it left to rule i to mend the component in trouble, with all that it mends (`mended`)? Not if culprit never saw the
// component, which it does not start then; and for a while not if that is being started, or another rule may yet mend it:
// one that has not fired for so long does not see the trouble.
bool is_trouble_left_to(RuleId i, const CauseNode& trouble, std::span<const ComponentId> mended,
                        const Knowledge& knowledge) {
  if (trouble.trouble == Trouble::kNeverSeen || !contains(mended, trouble.component)) return false;
  const ComponentState& state = knowledge.components[trouble.component];
  const auto is_recent = [&](Time at) { return knowledge.now < later(at, kLongestPlainEvidence); };
  if (state.is_coming_up() && is_recent(state.process_since)) return false;
  // A component that is down obeys no restart.
  if (answers_nothing(trouble.trouble) && !is_replaced_by(i, trouble.component, knowledge.rules))
    return false;
  if (!is_recent(trouble.onset.latest)) return true;
  return std::ranges::none_of(knowledge.states.touching(trouble.component), [&](RuleId rule) {
    const RuleState& other = knowledge.states[rule];
    const bool sees_it = other.phase != RulePhase::kQuiet
                             ? other.detection.trigger.known
                             : may_yet_show(rule, trouble.onset.latest, knowledge);
    return rule != i && sees_it && !knowledge.states.awaits_person(rule) &&
           contains(mended_by(rule, knowledge.rules), trouble.component);
  });
}

// Does rule j, which is left to a person, show what is wrong with components that i adapts, too (`touched`)?
// It is the failure i, seen at another threshold, and no cause of it.
bool is_seen_twice(RuleId j, RuleId i, std::span<const ComponentId> touched,
                   const Knowledge& knowledge) {
  return is_left_to_person(j, knowledge) && watches_the_same(j, i, knowledge.rules) &&
         std::ranges::all_of(touched_by(j, knowledge),
                             [&](ComponentId c) { return contains(touched, c); });
}

// Stands for the trouble of its components, too: its rule may have fired long after the process was down, as while
// culprit was deaf, or a group had time to come up.
void begin_with_its_process(CauseNode& failure,
                            std::span<const std::optional<TroubleSeen>> troubles,
                            const Knowledge& knowledge) {
  for (const ComponentId c : touched_by(failure.rule, knowledge)) {
    const auto& seen = troubles[c.index];
    const bool is_proof =
        seen && (seen->trouble == Trouble::kExited || seen->trouble == Trouble::kStopped ||
                 seen->trouble == Trouble::kHung || seen->trouble == Trouble::kNotActive ||
                 seen->trouble == Trouble::kSilent);
    if (!is_proof) continue;
    failure.onset.earliest = std::min(failure.onset.earliest, seen->onset.earliest);
    failure.troubled_since = std::min(failure.troubled_since, troubled_since(c, *seen, knowledge));
  }
}

// The pairs of consumer and producer that a DEPENDENCY names, ascending.
std::vector<std::pair<ComponentId, ComponentId>> declared_pairs(const RuleSet& rules) {
  std::vector<std::pair<ComponentId, ComponentId>> all;
  all.reserve(rules.dependencies.size());
  for (const Dependency& d : rules.dependencies) all.emplace_back(d.consumer, d.producer);
  std::ranges::sort(all);
  return all;
}

// Did its function never work while culprit watched?
bool never_worked(RuleId rule, const Knowledge& knowledge) {
  return knowledge.states[rule].detection.last_false == kLongAgo;
}

}  // namespace

Causes::Causes(const Knowledge& knowledge, const Reach& reach, const Paths& paths,
               std::span<const RuleId> imminent,
               std::span<const std::optional<TroubleSeen>> troubles)
    : places_(knowledge.rules.rules.size(), kAbsent) {
  add_rules(knowledge, imminent);
  add_troubles(knowledge, troubles);
  outlast_troubles(reach, knowledge);
  add_unsupplied(knowledge);
  causes_ = BitRows(size(), size());
  learned_ = BitRows(size(), size());
  loop_of_.resize(size());
  connect(knowledge, reach, paths);
  leave_out_slight(knowledge);
  find_loops(transposed(causes_, size()));
}

void Causes::add_rules(const Knowledge& knowledge, std::span<const RuleId> imminent) {
  const RuleStates& states = knowledge.states;
  std::vector<RuleId> rules = states.active();
  std::copy_if(states.exhausted().begin(), states.exhausted().end(), std::back_inserter(rules),
               [&](RuleId id) { return states.awaits_person(id); });
  rules.insert(rules.end(), imminent.begin(), imminent.end());
  sort_by_name(rules, knowledge.rules);
  for (const RuleId rule : rules) {
    places_[rule.index] = nodes_.size();
    const bool is_imminent = states[rule].phase == RulePhase::kQuiet;
    nodes_.push_back(
        {is_imminent ? CauseNode::Kind::kImminent : CauseNode::Kind::kFailure,
         rule,
         {},
         {},
         {},
         is_imminent ? onset_now(rule, knowledge.now, knowledge) : onset_of_node(rule, knowledge),
         {}});
    CauseNode& node = nodes_.back();
    node.is_outage = symptom_of(rule, knowledge) == Symptom::kOutage;
    node.first_onset = is_imminent ? node.onset.latest
                                   : std::min(node.onset.latest, first_onset_of(rule, knowledge));
    // A rule may be false for long after the onset: age(/c) > 30s.
    node.worked_until =
        std::min(is_imminent ? states[rule].detection.last_false : states[rule].worked_until,
                 node.first_onset);
    if (is_imminent) continue;
    // If an earlier culprit detected it, its onset is unknown.
    node.unclear_until = states[rule].onset ? unclear_until(rule, knowledge) : knowledge.now;
  }
}

void Causes::add_troubles(const Knowledge& knowledge,
                          std::span<const std::optional<TroubleSeen>> troubles) {
  std::vector<std::optional<Time>> began(
      knowledge.rules.components.size());  // the last failure of each
  for (const CauseNode& node : nodes_) {
    if (node.kind != CauseNode::Kind::kFailure) continue;
    for (const ComponentId c : touched_by(node.rule, knowledge))
      began[c.index] = std::max(began[c.index], std::optional(node.onset.latest));
  }
  for (CauseNode& node : nodes_) {
    if (node.kind == CauseNode::Kind::kFailure) begin_with_its_process(node, troubles, knowledge);
  }
  std::vector<ComponentId> components;
  for (std::size_t c = 0; c < troubles.size(); ++c) {
    const auto& trouble = troubles[c];
    if (trouble && (!began[c] || later(*began[c], kUsualDelay) < trouble->began))
      components.emplace_back(c);
  }
  const RuleSet& rules = knowledge.rules;
  std::sort(components.begin(), components.end(),
            [&](ComponentId a, ComponentId b) { return rules[a].name < rules[b].name; });
  for (const ComponentId c : components) {
    const TroubleSeen& seen = *troubles[c.index];
    nodes_.push_back({CauseNode::Kind::kTrouble, {}, c, seen.trouble, {}, seen.onset});
    nodes_.back().troubled_since = troubled_since(c, seen, knowledge);
  }
}

// A failure that began with a trouble upstream and outlasts it has another cause, which may have begun until then.
void Causes::outlast_troubles(const Reach& reach, const Knowledge& knowledge) {
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    const auto& past = knowledge.components[ComponentId(c)].past_trouble;
    if (!past || !reach.holds(ComponentId(c))) continue;
    const std::size_t place = reach.place_of(ComponentId(c));
    for (CauseNode& node : nodes_) {
      if (node.kind != CauseNode::Kind::kFailure || !past->may_have_led_to(node.onset)) continue;
      const bool is_upstream = std::ranges::any_of(
          touched_by(node.rule, knowledge),
          [&](ComponentId touched) { return has(reach.upstream(reach.place_of(touched)), place); });
      if (is_upstream)
        node.unclear_until =
            std::max(node.unclear_until, shows_by(node.rule, past->over, knowledge));
    }
  }
}

void Causes::add_unsupplied(const Knowledge& knowledge) {
  const std::size_t rules = nodes_.size();
  const bool is_any_never_seen = std::ranges::any_of(nodes_, [](const CauseNode& node) {
    return node.kind == CauseNode::Kind::kTrouble && node.trouble == Trouble::kNeverSeen;
  });
  const auto is_unsupplied = [&](ComponentId c) {
    return knowledge.graph.unsupplied_input(c).has_value();
  };
  for (std::size_t i = 0; i < rules; ++i) {
    const RuleId rule = nodes_[i].rule;
    // No data is needed to bring a component up.
    if (nodes_[i].kind != CauseNode::Kind::kFailure || !never_worked(rule, knowledge) ||
        is_about_states(rule, knowledge))
      continue;
    for (const ComponentId c : touched_by(rule, knowledge)) {
      std::optional<ComponentId> lacking;
      if (is_unsupplied(c)) lacking = c;
      // A component that was never seen may be missing anywhere upstream: the graph does not show where. One that publishes all
      // the same does not need that input.
      if (!lacking && is_any_never_seen) {
        lacking = knowledge.graph.first_upstream(c, [&](ComponentId supplier) {
          return is_unsupplied(supplier) && !is_publishing(supplier, knowledge);
        });
      }
      if (!lacking) continue;
      nodes_.push_back({CauseNode::Kind::kUnsupplied,
                        rule,
                        *lacking,
                        {},
                        *knowledge.graph.unsupplied_input(*lacking),
                        {}});
    }
  }
}

void Causes::connect(const Knowledge& knowledge, const Reach& reach, const Paths& paths) {
  // By place: which nodes touch it, and which spread from it to failures of values.
  BitRows touching(reach.size(), size());
  BitRows spreading(reach.size(), size());
  for (std::size_t i = 0; i < size(); ++i) {
    const CauseNode& node = nodes_[i];
    if (node.is_rule()) {
      for (const ComponentId c : touched_by(node.rule, knowledge))
        set(touching[reach.place_of(c)], i);
      for (const ComponentId c : spreads_from(node.rule, knowledge))
        set(spreading[reach.place_of(c)], i);
    } else if (node.kind == CauseNode::Kind::kTrouble) {
      set(touching[reach.place_of(node.component)], i);
      set(spreading[reach.place_of(node.component)], i);
    }
  }
  for (std::size_t i = 0; i < size(); ++i) {
    if (!nodes_[i].is_rule()) continue;
    const auto row = causes_[i];
    const std::vector<ComponentId> touched = touched_by(nodes_[i].rule, knowledge);
    const std::vector<ComponentId> mended = mended_by(nodes_[i].rule, knowledge.rules);
    const BitRows& from = nodes_[i].is_outage ? touching : spreading;
    for (const ComponentId c : downstream_of_causes(nodes_[i].rule, knowledge)) {
      for_each(paths.upstream(reach.place_of(c), nodes_[i].rule),
               [&](std::size_t place) { add(row, from[place]); });
    }
    connect_learned(knowledge, i);
    clear(row, i);
    for_each(row, [&](std::size_t j) {
      const bool is_trouble = nodes_[j].kind == CauseNode::Kind::kTrouble;
      const bool is_own = is_trouble
                              ? contains(touched, nodes_[j].component) ||
                                    is_trouble_left_to(nodes_[i].rule, nodes_[j], mended, knowledge)
                              : is_left_to(nodes_[j].rule, mended, knowledge) ||
                                    is_same_in_cooldown(nodes_[j].rule, touched, knowledge);
      const bool is_possible =
          is_trouble
              ? !is_own && can_explain(j, i, knowledge) && !may_be_effect(j, i, reach, knowledge)
              : !is_own && can_precede(j, i, knowledge) &&
                    !is_seen_twice(nodes_[j].rule, nodes_[i].rule, touched, knowledge);
      if (!is_possible) clear(row, j);
    });
  }
  for (std::size_t u = 0; u < size(); ++u) {
    if (nodes_[u].kind == CauseNode::Kind::kUnsupplied) set(causes_[index_of(nodes_[u].rule)], u);
  }
}

void Causes::connect_learned(const Knowledge& knowledge, std::size_t i) {
  for (const Couplings::Learned& each : knowledge.couplings.of(nodes_[i].rule)) {
    if (!holds(each.cause) || each.coupling.cleared == 0) continue;
    const std::size_t j = index_of(each.cause);
    if (has(causes_[i], j) || each.coupling.mean(Coupling::kRare) < kKnownCoupling) continue;
    set(causes_[i], j);
    set(learned_[i], j);
  }
}

// Leaves out, by level, less critical failures of values that are only ever reconfigured. Such a
// failure is no cause: its author finds nothing broken there, and the bad value may be old, because a
// publisher of better values exited. A DEPENDENCY says that it is one all the same. With ON_CHANGE it
// causes nothing at all: the robot is in another state of its mission, which may last.
void Causes::leave_out_slight(const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  BitRows slight(kLevels, size());
  for (std::size_t j = 0; j < size(); ++j) {
    if (!nodes_[j].is_rule()) continue;
    const RuleId rule = nodes_[j].rule;
    const bool is_mission = rules[rule].policies.on_change && !rules[rule].strategies.empty();
    const bool is_outage = !is_mission && symptom_of(rule, knowledge) == Symptom::kOutage;
    if (is_outage || may_be_broken(rule, rules)) continue;
    for (std::size_t level = is_mission ? 0 : level_of(rules[rule]) + 1; level < kLevels; ++level)
      set(slight[level], j);
  }
  const auto declared = declared_pairs(rules);
  std::vector<std::vector<ComponentId>> suppliers(size());  // of what may be left out
  const auto is_declared = [&](std::size_t j, const std::vector<ComponentId>& consumers) {
    if (declared.empty() || rules[nodes_[j].rule].policies.on_change) return false;
    if (suppliers[j].empty()) suppliers[j] = spreads_from(nodes_[j].rule, knowledge);
    return std::ranges::any_of(consumers, [&](ComponentId consumer) {
      return std::ranges::any_of(suppliers[j], [&](ComponentId producer) {
        return std::ranges::binary_search(declared, std::pair(consumer, producer));
      });
    });
  };
  for (std::size_t i = 0; i < size(); ++i) {
    if (!nodes_[i].is_rule()) continue;
    const std::vector<ComponentId> consumers = downstream_of_causes(nodes_[i].rule, knowledge);
    for_each(slight[level_of(rules[nodes_[i].rule])], [&](std::size_t cause) {
      if (has(causes_[i], cause) && !is_declared(cause, consumers)) clear(causes_[i], cause);
    });
  }
}

// A supplier that was never there, or never active, explains only a function that never worked. A
// lifecycle explains no rule that changes modes or reads lifecycles, which is about just that; and that of
// a component container says nothing of the components in it.
bool Causes::can_explain(std::size_t j, std::size_t i, const Knowledge& knowledge) const {
  const RuleId rule = nodes_[i].rule;
  const bool is_of_state =
      nodes_[j].trouble == Trouble::kNotActive || nodes_[j].trouble == Trouble::kNotYetActive;
  if (is_of_state &&
      (is_container(nodes_[j].component, knowledge.rules) || is_about_states(rule, knowledge)))
    return false;
  const bool was_never_there =
      nodes_[j].trouble == Trouble::kNeverSeen || nodes_[j].trouble == Trouble::kNotYetActive;
  if (was_never_there) return never_worked(rule, knowledge);
  return can_precede(j, i, knowledge);
}

// In a loop of the graph each may have silenced the other: the one that surely fell silent first did.
bool Causes::may_be_effect(std::size_t silent, std::size_t i, const Reach& reach,
                           const Knowledge& knowledge) const {
  const CauseNode& node = nodes_[silent];
  // No data keeps a component inactive. While a rule may still fire that mends the silent one, this is the likelier.
  const Onset& onset = nodes_[i].onset;
  const bool may_be_mended =
      knowledge.now < later(node.onset.latest, kLongestPlainEvidence) &&
      std::ranges::any_of(knowledge.states.touching(node.component), [&](RuleId rule) {
        return knowledge.states[rule].detection.trigger.known &&
               contains(mended_by(rule, knowledge.rules), node.component);
      });
  const bool is_earlier =
      reads_inactive(nodes_[i].rule, knowledge)
          ? node.onset.latest < onset.earliest
          : node.onset.latest <= (may_be_mended ? onset.latest : onset.earliest);
  if (node.trouble != Trouble::kSilent || is_earlier) return false;
  const auto upstream = reach.upstream(reach.place_of(node.component));
  return std::ranges::any_of(touched_by(nodes_[i].rule, knowledge),
                             [&](ComponentId c) { return has(upstream, reach.place_of(c)); });
}

bool Causes::can_precede(std::size_t j, std::size_t i, const Knowledge& knowledge) const {
  return nodes_[j].onset.earliest <= std::max(nodes_[i].onset.latest, nodes_[i].unclear_until) ||
         comes_back(j, i, knowledge);
}

// Was it there when the failure began, and came back before what it had caused can have cleared? For the failure it never
// went.
bool Causes::comes_back(std::size_t j, std::size_t i, const Knowledge& knowledge) const {
  const CauseNode& cause = nodes_[j];
  const CauseNode& effect = nodes_[i];
  if (effect.kind != CauseNode::Kind::kFailure) return false;
  const Duration passing = duration_of(kPassing, knowledge.rules);
  if (cause.is_rule()) {
    const Time gone = knowledge.states[cause.rule].gone_since;
    const bool was_there =
        effect.onset.earliest <= gone && gone <= knowledge.states[effect.rule].masked_until;
    if (was_there &&
        cause.onset.earliest <= echo_ends(effect.rule, cause.rule, gone, passing, knowledge))
      return true;
  }
  const auto was_in_trouble = [&](ComponentId c) {
    const auto& past = knowledge.components[c].past_trouble;
    if (!past || !past->may_have_led_to(effect.onset)) return false;
    const Time echo = echo_ends(effect.rule, {}, past->over, passing, knowledge);
    return cause.onset.latest <= std::max(echo, later(past->over, kLongestEvidence));
  };
  return cause.is_rule() ? std::ranges::any_of(touched_by(cause.rule, knowledge), was_in_trouble)
                         : was_in_trouble(cause.component);
}

double Causes::timely(std::size_t j, std::size_t i) const {
  const CauseNode& cause = nodes_[j];
  Time began = std::min(cause.onset.latest, cause.first_onset);
  if (cause.onset.latest > nodes_[i].onset.latest) began = std::min(began, cause.troubled_since);
  const Time worked = nodes_[i].worked_until;
  if (began == kLongAgo || began == kNever || worked <= later(began, kUsualDelay)) return 1;
  const double share = seconds(kUsualDelay) / seconds(worked - began);
  return nodes_[i].is_outage ? share * share : share;
}

// Kosaraju: what is visited first from the last of one search, backwards, is a loop.
void Causes::find_loops(const BitRows& effects) {
  BitRows open(1, nodes_.size());
  std::vector<std::size_t> path;
  std::vector<std::size_t> order;
  const auto open_all = [&] {
    for (std::size_t i = 0; i < nodes_.size(); ++i) set(open[0], i);
  };
  open_all();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (has(open[0], i))
      search(i, causes_, open[0], path, [&](std::size_t done) { order.push_back(done); });
  }
  open_all();
  for (auto root = order.rbegin(); root != order.rend(); ++root) {
    if (!has(open[0], *root)) continue;
    auto& loop = loops_.emplace_back();
    search(*root, effects, open[0], path, [&](std::size_t done) { loop.push_back(done); });
    std::sort(loop.begin(), loop.end());
    for (const std::size_t member : loop) loop_of_[member] = loops_.size() - 1;
  }
  for (const auto& loop : loops_) {
    if (loop.size() == 1) continue;
    for (const std::size_t member : loop) {
      for (const std::size_t other : loop) clear(causes_[member], other);
    }
  }
}

std::size_t Causes::index_of(RuleId rule) const {
  CULPRIT_ASSERT(holds(rule));
  return places_[rule.index];
}

}  // namespace culprit::diagnose
