// culprit study fleet: what a fleet's prior is worth to a new robot.
#include <algorithm>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>

#include "base/text_file.h"
#include "fleet_study/worlds.h"
#include "laboratory/commands.h"
#include "terminal/console.h"
#include "terminal/progress.h"

namespace culprit::lab {
namespace {

struct FleetStudyOptions {
  study::fleet::FleetCampaign campaign;
  std::string profile = "paper";
  unsigned jobs = std::max(1U, std::thread::hardware_concurrency());
  std::string format = "text";
  std::string output;
};

using Worlds = std::vector<std::unique_ptr<study::fleet::FleetWorld>>;

Expected<Worlds> worlds_of(const FleetStudyOptions& options) {
  using study::Probabilities;
  using study::rca::Priors;
  Worlds worlds;
  for (const Probabilities guesses : {Probabilities::kIdeal, Probabilities::kMisspecified}) {
    auto sunset = study::fleet::sunset_world(options.profile, guesses);
    if (!sunset) return Error{sunset.error()};
    worlds.push_back(std::move(*sunset));
  }
  for (const Priors guesses : {Priors::kRight, Priors::kOff, Priors::kFlat})
    worlds.push_back(study::fleet::random_world(guesses));
  return worlds;
}

int study_fleet(const FleetStudyOptions& options) {
  const auto worlds = worlds_of(options);
  if (!worlds) return fail(worlds.error(), kUsage);
  const StopSignals signals;
  std::vector<study::fleet::FleetRow> rows;
  {
    Progress progress(0, worlds->size() * options.campaign.models);
    std::uint64_t before = 0;
    for (const auto& world : *worlds) {
      const auto told = [&](std::uint64_t done) {
        progress.show(before + done);
        return !signals.stopped();
      };
      for (auto& row : study::fleet::study_fleet(*world, options.campaign, options.jobs, told))
        rows.push_back(std::move(row));
      if (signals.stopped()) break;
      before += options.campaign.models;
    }
  }
  if (signals.stopped()) return fail("interrupted; nothing is written", kFailed);
  const auto written = write_text(
      options.output, options.format == "json"       ? fleet_json(rows, options.campaign)
                      : options.format == "markdown" ? study::fleet::fleet_markdown(rows)
                                                     : fleet_text(rows, options.campaign));
  return written ? kOk : fail(written.error(), kFailed);
}

}  // namespace

void add_study_fleet(CLI::App& study, int& exit_code) {
  auto options = std::make_shared<FleetStudyOptions>();
  CLI::App* command = study.add_subcommand(
      "fleet", "Failed strategies that a fleet's experience spares a new robot");
  const auto number = [&](const char* name, std::uint32_t& value, const char* help) {
    command->add_option(name, value, help)->check(CLI::Range(1U, 100'000U))->capture_default_str();
  };
  number("--models", options->campaign.models, "Kinds of robots, each with rates of its own");
  number("--robots", options->campaign.robots,
         "Experienced robots of each model before the new one");
  number("--experience", options->campaign.experience, "Faults that each of them had");
  number("--first", options->campaign.first, "Failures of the new robot that count");
  command
      ->add_option("--most", options->campaign.pooling.most,
                   "Maximum weight of a prior, in outcomes")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  command->add_option("--profile", options->profile, "Which SUNSET: paper, head, october or live")
      ->capture_default_str();
  command->add_option("--seed", options->campaign.seed, "Seed of all random numbers")
      ->capture_default_str();
  command->add_option("--jobs", options->jobs, "Threads; the results do not depend on it")
      ->check(CLI::Range(1U, 1024U));
  command->add_option("--format", options->format, "text, markdown or json")
      ->check(CLI::IsMember({"text", "markdown", "json"}))
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "Write there (default: the terminal)")
      ->type_name("FILE");
  command->callback([options, &exit_code] { exit_code = study_fleet(*options); });
}

}  // namespace culprit::lab
