// The runs of a campaign on the live robot: each in a process of its own, several at once.
//
// Each run has a process of its own, because a world of SUNSET changes the environment of its
// process, and so that a run that exits or hangs affects no other. The processes of a run end with
// it, and it ends with us, however we end. A failed run is reported and played again; the third
// failure ends the campaign.
#pragma once

#include <atomic>
#include <utility>

#include "base/expected.h"
#include "base/temporary_folder.h"
#include "study/campaign.h"
#include "study/run_metrics.h"

namespace culprit::lab {

class LiveCampaign {
 public:
  static constexpr int kAttempts = 3;

  // Errors: no folder can be made for what the runs write.
  static Expected<LiveCampaign> open();

  // From several threads. `seed` is of this run (SunsetStudy::seed_of). An error is the reason of
  // the last failure, or that `stop` was set.
  Expected<study::RunMetrics> play(const study::Configuration& configuration, std::uint32_t run,
                                   std::uint64_t seed, const std::atomic<bool>& stop) const;

 private:
  explicit LiveCampaign(TemporaryFolder folder) : folder_(std::move(folder)) {}
  Expected<study::RunMetrics> attempt(const study::Configuration& configuration, std::uint32_t run,
                                      std::uint64_t seed, const std::atomic<bool>& stop) const;

  TemporaryFolder folder_;
};

}  // namespace culprit::lab
