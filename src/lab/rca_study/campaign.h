// A campaign of the root-cause benchmark: many random scenarios, each played by each planner.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "plan/bayes/objective.h"
#include "rca_study/episode.h"
#include "rca_study/generator.h"
#include "study/campaign.h"
#include "study/statistics/moments.h"

namespace culprit::study::rca {

// "naive", "first-failing", "topological", "random-walk", "paper", "bayes", those that wait for
// evidence ("patient", "informed": timing_planners.h), the styles of others (style_planner.h), and
// "optimum", which is for small robots only (optimum.h).
std::vector<std::string> planner_names();
// Those of a campaign that names none: without the styles of others and those that wait.
std::vector<std::string> usual_planners();
// Why there is no planner of that name; nothing if there is. "patient:2s" says how long it waits.
std::optional<std::string> complaint_about_planner(const std::string& name);

struct RcaCampaign {
  static constexpr std::string_view kStudy = "rca";  // its name in files

  std::vector<RcaSetting> settings;
  std::vector<std::string> planners;
  Objective objective = Objective::kBalanced;  // of bayes
  std::uint32_t episodes = 0;                  // of each setting and planner
  std::uint64_t seed = 0;
  // Instead of random ones: its settings are what setting_of() says, and each episode has other
  // luck.
  std::optional<RcaScenario> scenario;
  std::string version;  // of culprit

  // The rows: each planner in each setting.
  std::size_t rows() const { return settings.size() * planners.size(); }
};

// The results of one planner in one setting: shares and means over the episodes.
struct RcaRow {
  std::string planner;
  RcaSetting setting;
  std::int64_t episodes = 0;
  Moments exact;
  Moments first_right;
  std::int64_t effects = 0;
  std::int64_t grounded = 0;
  Moments wrong_component;
  Moments unnecessary;
  Moments strategies_per_fault;
  Moments downtime_s;
  Moments recovery_s;         // at least: where a robot did not recover, until the end
  std::int64_t censored = 0;  // episodes without a recovery
  Moments unresolved;
  std::optional<double> regret;  // expected cost beyond the optimum's, as a share (optimum.h)
  std::int64_t plans = 0;
  double planning_us = 0;

  void add(const EpisodeResult& result);
};

// The planner of that name. Errors: there is none, or the robot is too large for the optimum.
Expected<std::unique_ptr<const Planner>> make_planner(const std::string& name, Objective objective,
                                                      const RcaScenario& scenario);

// Told how many pieces of work are done of how many; says whether to go on. Null: go on.
using GoOn = std::function<bool(std::uint64_t done, std::uint64_t total)>;

// Row by row, setting by setting. The result depends on nothing but the campaign, apart from the
// time that planning took. `go_on` is asked after each episode, and after each robot of which the
// optimum was worked out; where it said no, nothing is given.
// @pre the planners exist
std::optional<std::vector<RcaRow>> run_campaign(const RcaCampaign& campaign, unsigned jobs,
                                                const GoOn& go_on);

// The scenario of an episode: the same for every planner.
RcaScenario scenario_of(const RcaCampaign& campaign, const RcaSetting& setting,
                        std::uint32_t episode);

// An episode again, to look at moment by moment. `id` is of rows() and the episodes. Errors: those
// of make_planner().
Expected<SingleRun> single_run(const RcaCampaign& campaign, RunId id);

// Are all its robots small enough for the optimum?
bool has_optimum(const RcaCampaign& campaign);

// How large a scenario is, how noisy its worst detector, and whether illness can go in circles.
RcaSetting setting_of(const RcaScenario& scenario);

}  // namespace culprit::study::rca
