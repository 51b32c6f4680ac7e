// Fits the vehicle of SUAVE's model to what was measured.
//
// ArduSub and the hydrodynamics under it are not modelled but stood for by a few constants
// (exemplars/suave/model/vehicle.h). Looked for are those with which managers, with their own
// reactions, come closest to the means and deviations that are wanted of them. Minimised is, over
// all targets and over search time and distance,
//
//     sum ((mean - mean_p) / sd_p)^2 + 1/4 (log (sd / sd_p))^2        p: measured; sds of at least
//     0.01
//
// by coordinate descent with halving steps. Every candidate plays the same seeds, so the same call
// gives the same result. Managers of which fewer than two runs were measured, or whose runs have no
// spread, are left out. So is culprit: what it is compared with is not fitted to it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "suave_study/campaign.h"

namespace culprit::study {

struct FitTarget {
  std::string manager;
  Moments search_s;
  Moments distance_m;
};

// The targets for the managers of a campaign; its own managers, vehicle and number of runs are
// replaced.
struct FitCampaign {
  SuaveCampaign campaign;
  std::vector<FitTarget> targets;
};

struct VehicleFit {
  suave::model::VehicleTraits vehicle;
  double misfit_before = 0;
  double misfit = 0;
};

// `runs` of each target for each candidate, 2 or more. `tell` is called for each step that made it
// better. Error: no target is left.
Expected<VehicleFit> fit_vehicle(std::vector<FitCampaign> campaigns,
                                 suave::model::VehicleTraits begin, std::uint32_t runs,
                                 unsigned jobs,
                                 const std::function<void(const std::string&)>& tell);

// Targets from the paper's table: all rows, or these: "bt" of the standard mission,
// "extended:bt" of the other. Error: there is no such row, or it is culprit's own.
Expected<std::vector<FitCampaign>> published_targets(const std::vector<std::string>& rows = {});

}  // namespace culprit::study
