#include "diagnose/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnose/known_down.h"
#include "diagnose/still_there.h"
#include "diagnose/touched.h"

namespace culprit::diagnose {

double own_cause(double prior, double explained) {
  return prior / (prior + (1 - prior) * explained);
}

Diagnosis::Diagnosis(const Knowledge& knowledge, const Causes& causes)
    : knowledge_(knowledge),
      causes_(causes),
      twins_(causes.size()),
      against_others_(causes.size()),
      claims_(causes.size(), 0) {
  find_twins();
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const bool is_sure = !causes[i].is_rule() || is_known_dead(i) || hangs_by_itself(i);
    prior_.push_back(is_sure ? kKnownDown : kCoincidence);
    against_others_[i] = own_cause(prior_[i], explained(i));
  }
  own_ = against_others_;
  for (const auto& loop : causes.loops()) {
    if (loop.size() > 1) divide(loop);
  }
  for (std::size_t i = 0; i < own_.size(); ++i) {
    for_each(causes.causes(i), [&](std::size_t j) {
      if (!has_better_twin(j, i)) claims_[i] += passes(j, i) * own_[j];
    });
  }
}

double Diagnosis::share(std::size_t j, std::size_t i) const {
  if (!has(causes_.causes(i), j) || has_better_twin(j, i)) return 0;
  return (1 - own_[i]) * passes(j, i) * own_[j] / claims_[i];
}

void Diagnosis::find_twins() {
  std::vector<std::pair<ComponentId, std::size_t>> exhausted;  // what it is about, and the failure
  for (std::size_t i = 0; i < causes_.size(); ++i) {
    const CauseNode& node = causes_[i];
    if (node.kind != CauseNode::Kind::kFailure || !knowledge_.states.awaits_person(node.rule))
      continue;
    for (const ComponentId c : touched_by(node.rule, knowledge_)) exhausted.emplace_back(c, i);
  }
  std::ranges::sort(exhausted);
  for (auto a = exhausted.begin(); a != exhausted.end(); ++a) {
    for (auto b = a + 1; b != exhausted.end() && b->first == a->first; ++b) {
      twins_[a->second].push_back(b->second);
      twins_[b->second].push_back(a->second);
    }
  }
}

bool Diagnosis::has_better_twin(std::size_t j, std::size_t i) const {
  return std::ranges::any_of(twins_[j], [&](std::size_t twin) {
    if (!has(causes_.causes(i), twin)) return false;
    const double of_twin = passes(twin, i);
    const double of_j = passes(j, i);
    return of_twin > of_j || (of_twin == of_j && twin < j);
  });
}

bool Diagnosis::is_explained_by(std::size_t i, std::size_t j) const {
  return has(causes_.causes(i), j) && is_enough(j, i);
}

bool Diagnosis::is_known_dead(std::size_t i) const {
  return causes_[i].is_rule() && is_known_down(causes_[i].rule, knowledge_);
}

bool Diagnosis::is_evident(std::size_t i) const {
  return is_known_dead(i) || (causes_[i].is_rule() && reads_inactive(causes_[i].rule, knowledge_));
}

bool Diagnosis::hangs_by_itself(std::size_t i) const {
  return is_about_hang(causes_[i].rule, knowledge_) && knowledge_.now >= may_wait_until(i);
}

Time Diagnosis::may_wait_until(std::size_t i) const {
  Time until = kLongAgo;
  const auto may_wait_for = [&](ComponentId supplier, Trouble trouble, Time since) {
    if (answers_nothing(trouble))
      until =
          std::max(until, may_wait_for_answer_until(causes_[i].rule, supplier, since, knowledge_));
  };
  for_each(causes_.causes(i), [&](std::size_t j) {
    const CauseNode& cause = causes_[j];
    if (cause.kind == CauseNode::Kind::kTrouble)
      return may_wait_for(cause.component, cause.trouble, cause.onset.latest);
    if (!cause.is_rule() || until == kNever) return;
    if (is_known_dead(j) || is_about_hang(cause.rule, knowledge_)) {
      until = kNever;
      return;
    }
    // It fires because a supplier is down, and does not repair that.
    for (const ComponentId c : touched_by(cause.rule, knowledge_)) {
      if (const auto seen = trouble_of(c, knowledge_))
        may_wait_for(c, seen->trouble, seen->onset.latest);
    }
  });
  return until;
}

bool Diagnosis::is_enough(std::size_t j, std::size_t i) const {
  return own_cause(prior_[i], passes(j, i)) < 0.5;
}

std::optional<std::size_t> Diagnosis::evident_in_loop(std::size_t i) const {
  for (const std::size_t j : causes_.loops()[causes_.loop_of(i)]) {
    if (j != i && is_evident(j) && is_enough(j, i)) return j;
  }
  return std::nullopt;
}

double Diagnosis::kappa(std::size_t j, std::size_t i) const {
  if (!causes_[i].is_rule() || !causes_[j].is_rule()) return Coupling::kUsual;
  // Most failures have learned nothing: no need to search.
  if (knowledge_.couplings.of(causes_[i].rule).empty()) return Coupling::kUsual;
  const double expected = causes_.is_learned(j, i) ? Coupling::kRare : Coupling::kUsual;
  return knowledge_.couplings.of(causes_[j].rule, causes_[i].rule).mean(expected);
}

double Diagnosis::against_others(std::size_t i, std::span<const std::size_t> no_causes) const {
  return no_causes.empty() ? against_others_[i] : own_cause(prior_[i], explained(i, no_causes));
}

double Diagnosis::explained(std::size_t i, std::span<const std::size_t> no_causes) const {
  double unexplained = 1;
  for_each(causes_.causes(i), [&](std::size_t j) {
    const bool is_no_cause = std::ranges::find(no_causes, j) != no_causes.end();
    if (!is_no_cause && !has_better_twin(j, i)) unexplained *= 1 - passes(j, i);
  });
  return 1 - unexplained;
}

void Diagnosis::divide(const std::vector<std::size_t>& loop) {
  Time first = kNever;
  for (const std::size_t i : loop) first = std::min(first, causes_[i].first_onset);
  double sum = 0;
  std::vector<double> weights;
  for (const std::size_t i : loop) sum += weights.emplace_back(weight(i, loop, first));
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const double omega = sum > 0 ? weights[k] / sum : 1 / static_cast<double>(loop.size());
    own_[loop[k]] *= omega + (1 - omega) * kCoincidence;
  }
}

double Diagnosis::weight(std::size_t i, const std::vector<std::size_t>& loop, Time first) const {
  // Even one at which all was tried may be the cause: it can have failed by accident.
  constexpr double kLeast = 0.01;
  const double delay = seconds(causes_[i].first_onset - first) / seconds(knowledge_.rules.cycle);
  double weight = std::max(kLeast, still_there(causes_[i].rule, knowledge_)) *
                  ((is_evident(i) ? kKnownDown : prior_[i]) / kCoincidence) / (1 + delay);
  for (const std::size_t k : loop) {
    if (k != i) weight *= std::max(kLeast, kappa(i, k)) / Coupling::kUsual;
  }
  return weight;
}

}  // namespace culprit::diagnose
