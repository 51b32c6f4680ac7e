#include "plan/bayes/responsibility.h"

#include <algorithm>
#include <cmath>

#include "plan/bayes/seen_down.h"
#include "plan/bayes/strategy_chances.h"

namespace culprit::plan {

double root_probability(double prior, double explained) {
  return prior / (prior + (1 - prior) * explained);
}

Responsibility::Responsibility(const Knowledge& knowledge, const Failures& failures)
    : knowledge_(knowledge),
      failures_(failures),
      against_others_(failures.size()),
      claims_(failures.size(), 0) {
  for (std::size_t i = 0; i < failures.size(); ++i) {
    own_.push_back(is_seen_down(failures[i], knowledge) ? kSeenDown : kCoincidence);
    against_others_[i] = root_probability(own_[i], explained(i));
  }
  root_ = against_others_;
  for (const auto& circle : failures.circles()) {
    if (circle.size() > 1) divide(circle);
  }
  for (std::size_t i = 0; i < root_.size(); ++i) {
    for_each(failures.causes(i), [&](std::size_t j) { claims_[i] += kappa(j, i) * root_[j]; });
  }
}

double Responsibility::share(std::size_t j, std::size_t i) const {
  if (!has(failures_.causes(i), j)) return 0;
  return (1 - root_[i]) * kappa(j, i) * root_[j] / claims_[i];
}

bool Responsibility::is_explained_by(std::size_t i, std::size_t j) const {
  return has(failures_.causes(i), j) && is_enough(j, i);
}

bool Responsibility::is_enough(std::size_t j, std::size_t i) const {
  return root_probability(own_[i], kappa(j, i)) < 0.5;
}

std::optional<std::size_t> Responsibility::dead_in_circle(std::size_t i) const {
  for (const std::size_t j : failures_.circles()[failures_.circle_of(i)]) {
    if (j != i && is_seen_down(failures_[j], knowledge_) && is_enough(j, i)) return j;
  }
  return std::nullopt;
}

double Responsibility::kappa(std::size_t j, std::size_t i) const {
  // Most failures have learned nothing: no need to search.
  if (knowledge_.couplings.of(failures_[i]).empty()) return Coupling::kUsual;
  return knowledge_.couplings.of(failures_[j], failures_[i]).mean(Coupling::kUsual);
}

double Responsibility::explained(std::size_t i) const {
  double unexplained = 1;
  for_each(failures_.causes(i), [&](std::size_t j) { unexplained *= 1 - kappa(j, i); });
  return 1 - unexplained;
}

void Responsibility::divide(const std::vector<std::size_t>& circle) {
  Time first = kNever;
  for (const std::size_t i : circle)
    first = std::min(first, knowledge_.states[failures_[i]].first_detected());
  double sum = 0;
  std::vector<double> weights;
  for (const std::size_t i : circle) sum += weights.emplace_back(weight(i, circle, first));
  for (std::size_t k = 0; k < circle.size(); ++k) {
    const double omega = sum > 0 ? weights[k] / sum : 1 / static_cast<double>(circle.size());
    root_[circle[k]] *= omega + (1 - omega) * kCoincidence;
  }
}

double Responsibility::weight(std::size_t i, const std::vector<std::size_t>& circle,
                              Time first) const {
  // Even one at which all was tried may be the cause: it can have failed by accident.
  constexpr double kLeast = 0.01;
  const RuleId rule = failures_[i];
  const RuleState& state = knowledge_.states[rule];
  const double delay = seconds(state.first_detected() - first) / seconds(knowledge_.rules.cycle);
  double weight =
      std::max(kLeast, still_there(rule, knowledge_)) * (own_[i] / kCoincidence) / (1 + delay);
  for (const std::size_t k : circle) {
    if (k != i) weight *= std::max(kLeast, kappa(i, k)) / Coupling::kUsual;
  }
  return weight;
}

}  // namespace culprit::plan
