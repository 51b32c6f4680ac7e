#include "plan/bayes/likely_causes.h"

#include <algorithm>
#include <iterator>
#include <tuple>

#include "diagnose/evidence.h"
#include "diagnose/known_down.h"
#include "diagnose/touched.h"
#include "plan/also_ended.h"
#include "plan/bayes/bayes_planner.h"
#include "plan/beside_exhausted.h"
#include "plan/ties.h"

namespace culprit::plan {

using namespace diagnose;

bool only_revives(const Strategy& strategy, const Knowledge& knowledge) {
  const std::vector<ComponentId> others = also_ended(strategy, knowledge);
  std::vector<ComponentId> revived;
  std::ranges::copy_if(strategy.components, std::back_inserter(revived), [&](ComponentId c) {
    return is_known_down(c, knowledge) && replaces(strategy, c);
  });
  const auto is_paused_for_it = [&](ComponentId c) {
    const auto& upstream = knowledge.graph.upstream(c);
    return std::ranges::any_of(
               revived,
               [&](ComponentId r) { return std::ranges::find(upstream, r) != upstream.end(); }) &&
           std::ranges::all_of(strategy.adaptations, [&](const Adaptation& a) {
             return a.component != c || a.type == AdaptationType::kDeactivate ||
                    a.type == AdaptationType::kActivate;
           });
  };
  return !revived.empty() && std::ranges::all_of(strategy.components, [&](ComponentId c) {
    return std::ranges::find(revived, c) != revived.end() || is_paused_for_it(c);
  }) && std::ranges::all_of(others, [&](ComponentId c) { return is_known_down(c, knowledge); });
}

namespace {

Time last_question(const Knowledge& knowledge) {
  Time last = kLongAgo;
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c)
    last = std::max(last, knowledge.components[ComponentId(c)].questioned.at);
  return last;
}

}  // namespace

LikelyCauses::LikelyCauses(const Knowledge& knowledge, const Examination& found,
                           std::span<const RuleId> failures)
    : knowledge_(knowledge),
      found_(found),
      causes_(found.causes()),
      diagnosis_(found.diagnosis()),
      unheard_(all_unheard()),
      last_question_(last_question(knowledge)),
      chances_(causes_.size()) {
  for (const RuleId rule : failures)
    chances_[causes_.index_of(rule)] = strategy_chances(rule, found.troubles(), knowledge_);
  contradicted_ = all_contradicted();
}

bool LikelyCauses::waits_for_person(std::size_t failure) const {
  const auto cause = of(failure);
  const auto is_in_vain = [&](StrategyId id) {
    return (cause || unheard_[failure]) && !only_revives(knowledge_.rules[id], knowledge_) &&
           !may_be_tried_beside_exhausted(id, knowledge_) &&
           (unheard_[failure] || is_left_to_person(*cause));
  };
  bool is_anything_left = false;
  for (const StrategyChance& each : chances_[failure]) {
    is_anything_left |= each.is_unheard();
    if (each.is_out()) continue;
    is_anything_left = true;
    const StrategyId id = each.strategy;
    const bool is_held = each.is_withheld && knowledge_.withheld[id.index].until == kNever;
    if (!is_held && !is_in_vain(id)) return false;
  }
  return is_anything_left;
}

std::vector<std::optional<ComponentId>> LikelyCauses::all_unheard() const {
  std::vector<std::optional<ComponentId>> all(causes_.size());
  for (std::size_t i = 0; knowledge_.components.is_any_unreached() && i < all.size(); ++i)
    all[i] = unheard_behind(i);
  return all;
}

// As Knowledge::unheard_behind(), but without what is seen to be well.
std::optional<ComponentId> LikelyCauses::unheard_behind(std::size_t failure) const {
  if (causes_[failure].kind != CauseNode::Kind::kFailure) return std::nullopt;
  const RuleId rule = causes_[failure].rule;
  if (!knowledge_.unheard_behind(rule)) return std::nullopt;
  std::optional<ComponentId> found;
  const auto look = [&](ComponentId c) {
    if (!found && knowledge_.is_unheard(c) && !knowledge_.is_older_than_silence(rule, c)) found = c;
  };
  for (const ComponentId c : knowledge_.rules[rule].components) {
    look(c);
    for_each(found_.paths().upstream(found_.reach().place_of(c), rule),
             [&](std::size_t place) { look(found_.reach()[place]); });
  }
  return found;
}

bool LikelyCauses::is_left_to_person(std::size_t node) const {
  switch (causes_[node].kind) {
    case CauseNode::Kind::kFailure:
      return knowledge_.states.awaits_person(causes_[node].rule) || waits_for_person(node);
    case CauseNode::Kind::kImminent:
      return false;
    case CauseNode::Kind::kTrouble: {
      const ComponentId component = causes_[node].component;
      const Time began = causes_[node].onset.latest;
      return std::ranges::none_of(knowledge_.states.touching(component), [&](RuleId rule) {
        // One that only pauses it for the sake of others does not repair it.
        if (!std::ranges::binary_search(knowledge_.rules[rule].repaired, component)) return false;
        const RuleState& state = knowledge_.states[rule];
        const bool sees_it = state.phase != RulePhase::kQuiet
                                 ? state.detection.trigger.known
                                 : may_yet_show(rule, began, knowledge_);
        return sees_it && !knowledge_.states.awaits_person(rule);
      });
    }
    case CauseNode::Kind::kUnsupplied:
      return true;
  }
  return true;
}

std::optional<std::size_t> LikelyCauses::of(std::size_t failure) const {
  const double own = diagnosis_.against_others(failure, contradicted_);
  if (own >= 0.5) return diagnosis_.evident_in_loop(failure);
  std::int64_t most = 0;
  std::size_t cause = failure;
  diagnosis_.for_each_share(failure, [&](std::size_t j, double share) {
    const bool is_no_cause = std::ranges::find(contradicted_, j) != contradicted_.end();
    if (parts(share) > most && !is_no_cause) std::tie(most, cause) = std::pair(parts(share), j);
  });
  if (most == 0) return std::nullopt;
  // To wait for a person in vain is worse than a strategy in vain. Not where the process upstream is known to be gone.
  constexpr double kWorthATry = 1.0 / 3;
  const bool may_be_wrong = is_exhausted(cause) && !is_known_down(causes_[cause].rule, knowledge_);
  if (own >= kWorthATry && may_be_wrong) return diagnosis_.evident_in_loop(failure);
  return cause;
}

// Do the components that the failure is about evidently work, so that all that is left to do at them is held back?
bool LikelyCauses::is_contradicted(std::size_t node) const {
  std::vector<ComponentId> at_work;
  for (const StrategyChance& each : chances_[node]) {
    if (each.is_out()) continue;
    if (!each.is_withheld || !knowledge_.withheld[each.strategy.index].is_contradicted)
      return false;
    std::ranges::copy(knowledge_.rules[each.strategy].components, std::back_inserter(at_work));
  }
  return !at_work.empty() &&
         std::ranges::all_of(touched_by(causes_[node].rule, knowledge_), [&](ComponentId c) {
           return std::ranges::find(at_work, c) != at_work.end();
         });
}

std::vector<std::size_t> LikelyCauses::all_contradicted() const {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < chances_.size(); ++i) {
    if (is_contradicted(i)) all.push_back(i);
  }
  return all;
}

bool LikelyCauses::is_exhausted(std::size_t node) const {
  return causes_[node].kind == CauseNode::Kind::kFailure &&
         knowledge_.states.awaits_person(causes_[node].rule);
}

std::optional<ComponentId> LikelyCauses::missing_member(RuleId rule) const {
  for (const StrategyId strategy : knowledge_.rules[rule].strategies) {
    for (const Adaptation& adaptation : knowledge_.rules[strategy].adaptations) {
      if (!adaptation.group) continue;
      const Group& group = knowledge_.rules[*adaptation.group];
      const auto missing = std::ranges::find_if(group.members, [&](ComponentId id) {
        const ComponentState& state = knowledge_.components[id];
        return state.alive == false || state.lifecycle != Lifecycle::kActive;
      });
      return missing == group.members.end() ? group.manager : *missing;
    }
  }
  return std::nullopt;
}

ComponentId LikelyCauses::likeliest_component(RuleId rule) const {
  const std::vector<ComponentId> about = touched_by(rule, knowledge_);
  if (about.empty()) return {};
  const bool only_reports = knowledge_.rules[rule].components.empty();
  if (about.size() == 1 || only_reports) return about.front();
  if (const auto missing = missing_member(rule)) return *missing;
  std::pair<std::int64_t, ComponentId> best{-1, {}};
  for (const ComponentId c : about) {
    double chance = 0;
    for (const StrategyId s : knowledge_.rules[rule].strategies) {
      const auto& adapted = knowledge_.rules[s].components;
      if (std::binary_search(adapted.begin(), adapted.end(), c))
        chance += knowledge_.beliefs[s].mean().value;
    }
    const bool is_better = parts(chance) > best.first ||
                           (parts(chance) == best.first &&
                            knowledge_.rules[c].name < knowledge_.rules[best.second].name);
    if (is_better) best = {parts(chance), c};
  }
  return best.second;
}

ComponentId LikelyCauses::component_of(std::size_t node) const {
  if (!causes_[node].is_rule()) return causes_[node].component;
  const RuleId rule = causes_[node].rule;
  const auto& adapted = knowledge_.rules[rule].components;
  // A camera that sees too little: its consumers do not depend on the lamp that is switched on.
  for (const ComponentId c : spreads_from(rule, knowledge_)) {
    if (!adapted.empty() && std::ranges::find(adapted, c) == adapted.end()) return c;
  }
  return likeliest_component(rule);
}

std::vector<Suspect> LikelyCauses::suspects(std::size_t failure) const {
  std::vector<std::pair<Suspect, std::size_t>> all;  // with their nodes
  const RuleId rule = causes_[failure].rule;
  all.push_back({{likeliest_component(rule), rule, diagnosis_.of(failure)}, failure});
  diagnosis_.for_each_share(failure, [&](std::size_t j, double share) {
    all.push_back({{component_of(j), causes_[j].is_rule() ? causes_[j].rule : rule, share}, j});
  });
  const std::size_t shown = std::min(all.size(), BayesPlanner::kSuspects);
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(shown), all.end(),
                    [&](const auto& a, const auto& b) {
                      const auto key = [&](const Suspect& s) {
                        return std::pair<std::int64_t, const std::string&>(
                            -parts(s.probability), knowledge_.rules[s.failure].name);
                      };
                      return key(a.first) < key(b.first);
                    });
  all.resize(shown);
  std::vector<Suspect> suspects;
  const Otherwise otherwise(failure, causes_, diagnosis_);
  const ComponentId responsible = all.front().first.component;
  for (auto& [suspect, node] : all) {
    for (PieceOfEvidence& piece : evidence_for(node, failure, otherwise, found_, knowledge_)) {
      if (piece.otherwise) {
        const ComponentId next = *piece.otherwise == failure ? likeliest_component(rule)
                                                             : component_of(*piece.otherwise);
        if (next != responsible) piece.evidence.without = knowledge_.rules[next].name;
      }
      suspect.evidence.push_back(std::move(piece.evidence));
    }
    suspects.push_back(std::move(suspect));
  }
  // Also of those that are no suspects, because they answered.
  if (last_question_ >= onset_of(rule, knowledge_).latest)
    std::ranges::move(answers_about(rule, knowledge_),
                      std::back_inserter(suspects.front().evidence));
  return suspects;
}

}  // namespace culprit::plan
