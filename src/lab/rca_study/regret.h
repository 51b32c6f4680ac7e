// How far bayes is from the optimum (optimum.h), robot by robot, for each objective.
//
// Random robots of one to four components with one to three faults, with and without circles, of
// one level of criticality and of mixed ones, each equally often. All is expectation; only which
// robots these are is left to chance.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plan/bayes/objective.h"
#include "rca_study/campaign.h"
#include "study/tables/table.h"

namespace culprit::study::rca {

struct RegretCampaign {
  std::uint32_t systems = 1000;  // > 0
  std::uint64_t seed = 1;
  bool is_as_told = true;
};

// Of one objective: each system's regret, as a share of the optimum's cost.
struct Regrets {
  Objective objective = Objective::kBalanced;
  std::vector<double> of;  // by system

  double mean() const;
  double percentile_95() const;  // the smallest that 95 % do not exceed
  std::size_t worst() const;     // the system
};

// The robot of this number, which is below `campaign.systems`.
RcaSetting regret_setting(const RegretCampaign& campaign, std::uint32_t system);
RcaScenario regret_scenario(const RegretCampaign& campaign, std::uint32_t system);

// One for each objective. `go_on` is asked after each system, and `is_stopped`, on any thread,
// before each of its objectives, which takes up to a second (null: never): where the one said no, or
// the other yes, nothing is given.
std::optional<std::vector<Regrets>> measure_regret(const RegretCampaign& campaign, unsigned jobs,
                                                   const GoOn& go_on,
                                                   const std::function<bool()>& is_stopped);

// In a form of study/tables/render.h; and as
//
//     {"regret": {"systems": 1000, "seed": 1, "as_told": true,
//                 "objectives": [{"objective": "balanced", "mean": 0.004, "percentile_95": 0.02,
//                                 "worst": 0.1, "worst_system": 17}]}}
Table regret_table(const RegretCampaign& campaign, const std::vector<Regrets>& regrets);
std::string regret_json(const RegretCampaign& campaign, const std::vector<Regrets>& regrets);

}  // namespace culprit::study::rca
