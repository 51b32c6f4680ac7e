// Is there a part of the space of unpublished constants in which Algorithm 1 reproduces the order
// of the paper's configurations?
//
// A full factorial design: every value of each constant with every value of the others. At each
// point the eight configurations are played, and each metric's means are ranked beside the paper's.
// The reference manager has the durations of its code, so patience is varied for others only.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "study/paper_claims.h"
#include "study/tables/table.h"
#include "sunset_study/variation.h"

namespace culprit::study {

struct SweepPoint {
  std::string planner;
  Variation variation;
  std::vector<OrderAgreement> order;  // by published metric
  // Change of the mean reaction by S where C is on, in percent: without D, with D.
  std::array<double, 2> reaction_by_impact{};
  // The paper expects S to shorten the downtime where a redeployment takes much longer than a
  // restart: in how many of the four configurations it does so significantly (Tukey).
  int downtime_shortened = 0;
  int means_near = 0;  // of the 32, those that differ from the paper's by less than half its sd
};

struct SweepCampaign {
  std::vector<std::string> planners;
  std::string profile = "paper";
  std::uint32_t runs = 54;  // of each configuration: each scenario three times
  std::uint64_t seed = 1;
};

// `told` is called with the number of finished points, and says whether to go on.
Expected<std::vector<SweepPoint>> sweep(const SweepCampaign& campaign, unsigned jobs,
                                        const std::function<bool(std::uint64_t)>& told);
std::uint64_t sweep_size(const SweepCampaign& campaign);

// The mean rank correlations at each value of each constant; the points that come closest.
std::vector<Table> sweep_tables(const std::vector<SweepPoint>& points,
                                const SweepCampaign& campaign);

// {"study": "sunset", "campaign": {"command", "version", "profile", "runs", "seed"},
//  "sweep": [{"planner", "relaunch_s", "blackboard_period_s", "window", "patience",
//             "rho": {"ratio": 0.76, ...}, "reaction_by_impact": [-35, -30],
//             "downtime_shortened": 1, "means_near": 25}]}
// `command` repeats the sweep; a correlation that is not defined is null.
std::string sweep_json(const std::vector<SweepPoint>& points, const SweepCampaign& campaign,
                       const std::string& command, const std::string& version);

}  // namespace culprit::study
