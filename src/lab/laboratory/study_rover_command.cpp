#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "base/text_file.h"
#include "demo/rover_study.h"
#include "json/json.h"
#include "laboratory/commands.h"
#include "plan/paper_planner.h"
#include "terminal/console.h"

namespace culprit::lab {
namespace {

struct RoverOptions {
  std::vector<std::string> managers = {"none", "respawn", "paper", "bayes"};
  std::vector<std::string> faults;
  bool is_live = false;
  std::uint64_t seed = 1;
  double patience_s = 60;
  std::string output;
};

// The figures of one manager over all faults that something mends.
struct RoverTotals {
  int faults = 0;
  int healed = 0;
  int blamed = 0;
  int others = 0;
  int collisions = 0;
  double stood_s = 0;
  std::vector<double> healed_s{};

  void add(const RoverDemo::Play& play, const PlayOutcome& outcome) {
    others += outcome.unnecessary_redeployments;
    collisions += outcome.collisions;
    if (!std::ranges::all_of(play.faults, &rover::Fault::is_fixable)) return;
    ++faults;
    stood_s += outcome.downtime;
    blamed += is_blamed(play, outcome) ? 1 : 0;
    if (!outcome.healed_s) return;
    ++healed;
    healed_s.push_back(*outcome.healed_s);
  }
  double median_s() {
    if (healed_s.empty()) return 0;
    std::ranges::sort(healed_s);
    return healed_s[healed_s.size() / 2];
  }
};

RoverDemo::Options demo_of(const std::string& manager, std::uint64_t seed) {
  RoverDemo::Options demo;
  demo.seed = seed;
  if (manager == "none") demo.manager = RoverDemo::Manager::kNone;
  if (manager == "respawn") demo.manager = RoverDemo::Manager::kRespawn;
  if (manager == "paper") demo.planner = [] { return std::make_unique<PaperPlanner>(); };
  return demo;
}

Json to_json(const std::string& manager, const PlayOutcome& outcome) {
  Json row{{"manager", manager},
           {"fault", outcome.name},
           {"noticed", !outcome.failures.empty()},
           {"blamed", outcome.blamed},
           {"healed_s", nullptr},
           {"stood_s", outcome.downtime},
           {"redeployed", outcome.redeployed},
           {"other_redeployments", outcome.unnecessary_redeployments},
           {"goals", outcome.goals},
           {"collisions", outcome.collisions},
           {"complaint", outcome.complaint}};
  if (outcome.healed_s) row["healed_s"] = *outcome.healed_s;
  return row;
}

int study_rover(const RoverOptions& options) {
  std::vector<RoverDemo::Play> plays;
  for (const std::string& name : options.faults) {
    auto play = RoverDemo::find_play(name);
    if (!play) return fail(play.error(), kUsage);
    plays.push_back(std::move(*play));
  }
  if (plays.empty()) {
    for (const rover::Fault& fault : rover::faults())
      plays.push_back(*RoverDemo::find_play(fault.name));
  }
  StopSignals signals;
  Json rows = Json::array();
  std::string summary = fmt::format("{:<9} {:>7} {:>7} {:>8} {:>8} {:>7} {:>11}\n", "manager",
                                    "healed", "blamed", "median", "stood", "others", "collisions");
  for (const std::string& manager : options.managers) {
    say(stdout, "manager {}\n{}", manager, header_of_rover_table());
    RoverTotals totals;
    RoverStudy study{.demo = demo_of(manager, options.seed),
                     .plays = plays,
                     .patience = from_seconds(options.patience_s)};
    study.on_outcome = [&](const RoverDemo::Play& play, const PlayOutcome& outcome) {
      say(stdout, "{}", row_of(play, outcome));
      rows.push_back(to_json(manager, outcome));
      totals.add(play, outcome);
    };
    if (const auto played = play_all(study, signals.stopped()); !played)
      return fail(played.error(), kFailed);
    summary += fmt::format("{:<9} {:>3}/{:<3} {:>3}/{:<3} {:>6.1f} s {:>6.0f} s {:>7} {:>11}\n",
                           manager, totals.healed, totals.faults, totals.blamed, totals.faults,
                           totals.median_s(), totals.stood_s, totals.others, totals.collisions);
  }
  say(stdout, "\n{}", summary);
  if (options.output.empty()) return kOk;
  const auto written = write_text(options.output, to_indented(rows) + "\n");
  return written ? kOk : fail(written.error(), kFailed);
}

}  // namespace

void add_study_rover(CLI::App& study, int& exit_code) {
  auto options = std::make_shared<RoverOptions>();
  CLI::App* command = study.add_subcommand(
      "rover", "Each fault of the live rover, under Nav2 alone, with respawning, and with culprit");
  command->add_flag("--live", options->is_live, "Real processes; there is no model of the rover")
      ->required();
  command->add_option("--manager", options->managers, "Managers beside Nav2's lifecycle managers")
      ->check(CLI::IsMember({"none", "respawn", "paper", "bayes"}))
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--fault", options->faults,
                   "Faults by name, several at once as kill:amcl+lidar:stall (default: each)")
      ->delimiter(',');
  command->add_option("--patience", options->patience_s, "Longest wait for a repair, in seconds")
      ->check(CLI::Range(1.0, 600.0))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the world")->capture_default_str();
  command->add_option("-o,--output", options->output, "Write the plays there, as JSON")
      ->type_name("FILE");
  command->callback([options, &exit_code] { exit_code = study_rover(*options); });
}

}  // namespace culprit::lab
