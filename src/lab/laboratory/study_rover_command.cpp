#include <algorithm>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/text_file.h"
#include "demo/demo_setup.h"
#include "demo/rover_demo.h"
#include "json/json.h"
#include "laboratory/commands.h"
#include "laboratory/study_output.h"
#include "rover_study/live.h"
#include "rover_study/study.h"
#include "terminal/console.h"

namespace culprit::lab {
namespace {

using study::RoverCampaign;

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
  std::string output;  // of the plays; empty: none
  std::string tables;  // a file; empty: the standard output
};

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
          {"collisions", row.collisions ? Json(*row.collisions) : Json(nullptr)},
          {"calls", row.calls},
          {"unfixable", row.unfixable},
          {"stands", row.stands}};
}

Json to_json(const rover::Play& play, const std::string& manager,
             const study::RoverResult& result) {
  return {{"manager", manager},
          {"faults", play.name},
          {"seed", play.seed},
          {"noticed", result.is_noticed},
          {"healed_s", result.healed_s ? Json(*result.healed_s) : Json(nullptr)},
          {"stood_s", result.stood_s},
          {"goals", result.goals},
          {"blamed", result.names},
          {"strategies", result.strategies},
          {"wrong_restarts", result.wrong_restarts},
          {"collisions", result.collisions ? Json(*result.collisions) : Json(nullptr)},
          {"calls", result.calls},
          {"complaint", result.complaint}};
}

Expected<std::vector<rover::Play>> plays_of(const RoverOptions& options,
                                            const RoverCampaign& campaign) {
  std::vector<rover::Play> plays;
  for (const std::string& name : options.faults) {
    auto play = rover::find_play(name, options.seed);
    if (!play) return Error{play.error()};
    plays.push_back(std::move(*play));
  }
  if (!plays.empty()) return plays;
  plays = study::plays_of(campaign);
  // One rover is there for all of them.
  for (rover::Play& play : plays) play.seed = options.is_live ? options.seed : play.seed;
  return plays;
}

// Each play as soon as it is over.
Expected<study::RoverResults> play_live(const RoverOptions& options, const RoverCampaign& campaign,
                                        const std::vector<rover::Play>& plays) {
  StopSignals signals;
  study::RoverResults all;
  for (const std::string& manager : campaign.managers) {
    say(stderr, "manager {}\n{}", manager, study::header_of_plays());
    auto results =
        study::play_live(plays, manager, from_seconds(options.patience_s), signals.stopped(),
                         [](const rover::Play& play, const study::RoverResult& result) {
                           say(stderr, "{}", study::line_of(play, result));
                         });
    if (!results) return Error{results.error()};
    all.push_back(std::move(*results));
  }
  return all;
}

int print(const RoverOptions& options, const RoverCampaign& campaign,
          const std::vector<rover::Play>& plays, const study::RoverResults& results) {
  std::vector<study::RoverRow> rows;
  Json json_rows = Json::array();
  Json json_plays = Json::array();
  std::string left;
  for (std::size_t m = 0; m < campaign.managers.size(); ++m) {
    const std::string& manager = campaign.managers[m];
    rows.push_back(study::row_of(manager, plays, results[m]));
    json_rows.push_back(to_json(rows.back()));
    for (std::size_t i = 0; i < plays.size(); ++i)
      json_plays.push_back(to_json(plays[i], manager, results[m][i]));
    if (manager == "bayes") left = study::left_of(manager, plays, results[m]);
  }
  if (!options.output.empty()) {
    const auto written = write_text(options.output, to_indented(json_plays) + "\n");
    if (!written) return fail(written.error(), kFailed);
  }
  if (options.is_json) return say(stdout, "{}\n", to_indented(json_rows)), kOk;
  std::vector<study::Table> tables = {study::table_of(rows)};
  if (auto compared = study::comparisons_of("bayes", campaign, plays, results);
      !compared.rows.empty())
    tables.push_back(std::move(compared));
  const auto text = tables_as(tables, options.format);
  if (!text) return fail(text.error(), kUsage);
  const auto written = write_text(options.tables, fmt::format("{}\n{}", *text, left));
  return written ? kOk : fail(written.error(), kFailed);
}

int study_rover(const RoverOptions& options) {
  using enum RoverCampaign::Faults;
  RoverCampaign campaign{.faults = options.several == "pairs"     ? kPairs
                                   : options.several == "triples" ? kTriples
                                                                  : kSingle,
                         .triples = options.triples,
                         .seed = options.seed,
                         .jobs = options.jobs};
  const std::vector<std::string>& known =
      options.is_live ? study::live_rover_managers() : study::rover_managers();
  campaign.managers = options.managers.empty() ? known : options.managers;
  for (const std::string& manager : options.managers) {
    if (std::ranges::find(known, manager) == known.end())
      return fail(
          fmt::format("--manager {}: there is none; choose of {}", manager, fmt::join(known, ", ")),
          kUsage);
  }
  const auto plays = plays_of(options, campaign);
  if (!plays) return fail(plays.error(), kUsage);
  if (!options.is_live) {
    const RuleSet rules = embedded_rules("rover.rules", RoverDemo::rule_text());
    return print(options, campaign, *plays, study::play_all(rules, *plays, campaign));
  }
  const auto results = play_live(options, campaign, *plays);
  return results ? print(options, campaign, *plays, *results) : fail(results.error(), kFailed);
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
  command->add_option("--tables", options->tables, "Write the tables there (default: the terminal)")
      ->type_name("FILE");
  command->callback([options, &exit_code] { exit_code = study_rover(*options); });
}

}  // namespace culprit::lab
