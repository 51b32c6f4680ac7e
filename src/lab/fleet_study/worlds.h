// The robots of the fleet study.
#pragma once

#include <memory>

#include "base/expected.h"
#include "fleet_study/fleet_study.h"
#include "rca_study/learning.h"
#include "study/campaign.h"

namespace culprit::study::fleet {

// SUNSET (its model of this profile): which of the exemplar's 18 combinations of faults comes how
// often is drawn for each model, and for each robot around that. `guesses`: the rule file's success
// probabilities, where each combination is as frequent as any other. Errors: no such profile.
Expected<std::unique_ptr<FleetWorld>> sunset_world(const std::string& profile,
                                                   Probabilities guesses);

// Random robots of the root-cause benchmark (rca_study/generator.h), one fault at a time: how often
// what helps is drawn for each robot around its model's rate. `guesses`: what the rules say.
std::unique_ptr<FleetWorld> random_world(rca::Priors guesses);

}  // namespace culprit::study::fleet
