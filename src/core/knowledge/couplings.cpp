#include "knowledge/couplings.h"

#include <algorithm>

namespace culprit {
namespace {

bool is_before(const Couplings::Learned& learned, RuleId cause) { return learned.cause < cause; }

}  // namespace

Couplings::Couplings(const RuleSet& rules) : by_effect_(rules.rules.size()) {}

Coupling Couplings::of(RuleId cause, RuleId effect) const {
  const auto& all = by_effect_[effect.index];
  const auto found = std::lower_bound(all.begin(), all.end(), cause, is_before);
  return found != all.end() && found->cause == cause ? found->coupling : Coupling();
}

Coupling& Couplings::place(RuleId cause, RuleId effect) {
  auto& all = by_effect_[effect.index];
  auto found = std::lower_bound(all.begin(), all.end(), cause, is_before);
  if (found == all.end() || found->cause != cause) found = all.insert(found, {cause, {}});
  return found->coupling;
}

void Couplings::set(RuleId cause, RuleId effect, Coupling coupling) {
  coupling.spared = std::min(coupling.spared, Coupling::kMostSpared);
  place(cause, effect) = coupling;
}

void Couplings::learn(RuleId cause, RuleId effect, Coupling outcome) {
  Coupling& coupling = place(cause, effect);
  coupling.cleared = forgetting_ * coupling.cleared + outcome.cleared;
  coupling.stayed = forgetting_ * coupling.stayed + outcome.stayed;
  coupling.spared = std::min(forgetting_ * coupling.spared + outcome.spared, Coupling::kMostSpared);
}

}  // namespace culprit
