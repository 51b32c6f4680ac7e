#include <algorithm>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/text_file.h"
#include "demo/demo_setup.h"
#include "demo/rover_study.h"
#include "json/json.h"
#include "laboratory/commands.h"
#include "plan/paper_planner.h"
#include "rover_study/study.h"
#include "terminal/console.h"

namespace culprit::lab {
namespace {

using study::RoverCampaign;
using study::RoverFormat;

struct RoverOptions {
  std::vector<std::string> managers;
  std::vector<std::string> faults;
  bool is_live = false;
  std::string several = "single";
  std::uint32_t triples = 1000;
  unsigned jobs = std::max(1U, std::thread::hardware_concurrency());
  std::string format = "text";
  bool is_json = false;
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

const std::vector<std::string> kLiveManagers = {"none", "respawn", "paper", "bayes"};

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

int study_live(const RoverOptions& options) {
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
  const std::vector<std::string> managers =
      options.managers.empty() ? kLiveManagers : options.managers;
  for (const std::string& manager : managers) {
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

// The figures of a row, of the plays in which something mends each fault.
Json to_json(const study::RoverRow& row) {
  const auto number = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  return {{"manager", row.manager},
          {"plays", row.plays},
          {"healed", row.healed},
          {"median_s", number(row.median_s)},
          {"percentile_95_s", number(row.late_s)},
          {"stood_s", row.stood_s.mean()},
          {"goals_an_hour", row.goals_an_hour.mean()},
          {"wrong_restarts", row.wrong_restarts},
          {"faults", row.faults},
          {"blamed", row.blamed},
          {"calls", row.calls},
          {"unfixable", row.unfixable},
          {"stands", row.stands}};
}

Json to_json(const study::RoverPlay& play, const std::string& manager,
             const study::RoverResult& result) {
  return {{"manager", manager},
          {"faults", play.name()},
          {"seed", play.seed},
          {"healed_s", result.healed_s ? Json(*result.healed_s) : Json(nullptr)},
          {"stood_s", result.stood_s},
          {"goals", result.goals},
          {"blamed", result.names},
          {"strategies", result.strategies},
          {"wrong_restarts", result.wrong_restarts},
          {"calls", result.calls},
          {"complaint", result.complaint}};
}

Expected<std::vector<study::RoverPlay>> named_plays(const RoverOptions& options) {
  std::vector<study::RoverPlay> plays;
  for (const std::string& name : options.faults) {
    const auto play = RoverDemo::find_play(name);
    if (!play) return Error{play.error()};
    plays.push_back({play->faults, options.seed});
  }
  return plays;
}

int study_model(const RoverOptions& options) {
  using enum RoverCampaign::Faults;
  const auto faults = options.several == "pairs"     ? kPairs
                      : options.several == "triples" ? kTriples
                                                     : kSingle;
  const auto format = options.format == "markdown" ? RoverFormat::kMarkdown : RoverFormat::kText;
  RoverCampaign campaign{
      .faults = faults, .triples = options.triples, .seed = options.seed, .jobs = options.jobs};
  if (!options.managers.empty()) campaign.managers = options.managers;
  auto plays = named_plays(options);
  if (!plays) return fail(plays.error(), kUsage);
  if (plays->empty()) plays = study::plays_of(campaign);
  const RuleSet rules = embedded_rules("rover.rules", RoverDemo::rule_text());
  const study::RoverResults results = study::play_all(rules, *plays, campaign);

  std::vector<study::RoverRow> rows;
  Json json_rows = Json::array();
  Json json_plays = Json::array();
  std::string left;
  for (std::size_t m = 0; m < campaign.managers.size(); ++m) {
    const std::string& manager = campaign.managers[m];
    rows.push_back(study::row_of(manager, *plays, results[m]));
    json_rows.push_back(to_json(rows.back()));
    for (std::size_t i = 0; i < plays->size(); ++i)
      json_plays.push_back(to_json((*plays)[i], manager, results[m][i]));
    if (manager == "bayes") left = study::left_of(manager, *plays, results[m]);
  }
  if (!options.output.empty()) {
    const auto written = write_text(options.output, to_indented(json_plays) + "\n");
    if (!written) return fail(written.error(), kFailed);
  }
  if (options.is_json) return say(stdout, "{}\n", to_indented(json_rows)), kOk;
  say(stdout, "{}\n{}\n{}", study::table_of(rows, format),
      study::comparisons_of("bayes", campaign, *plays, results, format), left);
  return kOk;
}

int study_rover(const RoverOptions& options) {
  const std::vector<std::string>& known = options.is_live ? kLiveManagers : study::rover_managers();
  for (const std::string& manager : options.managers) {
    if (std::ranges::find(known, manager) == known.end())
      return fail(
          fmt::format("--manager {}: there is none; choose of {}", manager, fmt::join(known, ", ")),
          kUsage);
  }
  return options.is_live ? study_live(options) : study_model(options);
}

}  // namespace

void add_study_rover(CLI::App& study, int& exit_code) {
  auto options = std::make_shared<RoverOptions>();
  CLI::App* command = study.add_subcommand(
      "rover", "Faults of the rover under culprit and other managers, in virtual time or live");
  command->add_flag("--live", options->is_live, "Run real processes instead of the model");
  command
      ->add_option(
          "--manager", options->managers,
          "none, nav2, respawn, watchdog, paper, bayes, oracle; with --live: none, respawn, "
          "paper, bayes (default: all)")
      ->delimiter(',');
  command
      ->add_option("--fault", options->faults,
                   "Faults by name, several at once as kill:amcl+lidar:stall (default: each)")
      ->delimiter(',');
  command->add_option("--faults", options->several, "How many at once")
      ->check(CLI::IsMember({"single", "pairs", "triples"}))
      ->capture_default_str();
  command->add_option("--triples", options->triples, "Random triples")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--jobs", options->jobs, "Threads")->check(CLI::Range(1, 1024));
  command->add_option("--format", options->format, "Format of the tables")
      ->check(CLI::IsMember({"text", "markdown"}))
      ->capture_default_str();
  command->add_flag("--json", options->is_json, "Print the table as JSON");
  command
      ->add_option("--patience", options->patience_s,
                   "Longest wait for a repair with --live, in seconds")
      ->check(CLI::Range(1.0, 600.0))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the world")->capture_default_str();
  command->add_option("-o,--output", options->output, "Write the plays there, as JSON")
      ->type_name("FILE");
  command->callback([options, &exit_code] { exit_code = study_rover(*options); });
}

}  // namespace culprit::lab
