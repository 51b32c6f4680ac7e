// culprit study suave: the paper's second evaluation, with the managers that it compares with; and
// how far its model can be believed.
#include <algorithm>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/text_file.h"
#include "laboratory/commands.h"
#include "laboratory/study_output.h"
#include "laboratory/study_runs.h"
#include "study/csv.h"
#include "suave_study/fit.h"
#include "suave_study/settings_json.h"
#include "suave_study/suave_claims.h"
#include "suave_study/suave_record.h"
#include "suave_study/validation.h"

namespace culprit::lab {
namespace {

// As they were typed; empty: as the mission has it.
struct SettingTexts {
  std::string visibility_period;
  std::string visibility_shift;
  std::string visibility;
  std::vector<std::string> thruster_events;
  bool no_thruster_events = false;
  std::string start;
  std::string time_limit;
};

struct SuaveOptions {
  bool extended = false;
  bool stress = false;
  std::vector<std::string> managers;  // none: all
  std::string generation = "era";
  std::uint32_t runs = 100;
  std::uint64_t seed = 1;
  unsigned jobs = std::max(1U, std::thread::hardware_concurrency());
  SettingTexts settings;
  std::string vehicle;  // a file; empty: the one fitted to the published runs
  bool claims = false;
  std::vector<std::string> fit;       // files of recorded runs
  std::vector<std::string> fit_rows;  // of the paper's table
  std::vector<std::string> validate;  // likewise
  double margin_sd = 0.5;
  ShardOptions shard;
  StudyOutput output;
  std::string version;
};

Expected<double> one_number(const std::string& text) {
  const auto range = suave::model::parse_range(text);
  if (range && range->turns.empty() && range->low == range->high) return range->low;
  return Error{"'" + text + "' is no number of seconds"};
}

Expected<void> apply(const SettingTexts& texts, suave::model::MissionSettings& settings) {
  if (!texts.visibility_period.empty()) {
    const auto period = one_number(texts.visibility_period);
    if (!period) return Error{"--visibility-period: " + period.error()};
    settings.visibility_period_s = *period;
  }
  if (!texts.visibility_shift.empty()) {
    const auto shift = suave::model::parse_range(texts.visibility_shift);
    if (!shift) return Error{"--visibility-shift: " + shift.error()};
    settings.visibility_shift_s = *shift;
  }
  if (!texts.visibility.empty()) {
    const auto visibility = suave::model::parse_range(texts.visibility);
    if (!visibility) return Error{"--visibility: " + visibility.error()};
    if (!visibility->turns.empty()) return Error{"--visibility: it is one for all runs"};
    settings.least_visibility_m = visibility->low;
    settings.most_visibility_m = visibility->high;
  }
  if (!texts.start.empty()) {
    const auto start = suave::model::parse_range(texts.start);
    if (!start) return Error{"--start: " + start.error()};
    settings.start_y_m = *start;
  }
  if (!texts.time_limit.empty()) {
    const auto limit = one_number(texts.time_limit);
    if (!limit) return Error{"--time-limit: " + limit.error()};
    settings.time_limit_s = *limit;
  }
  if (texts.no_thruster_events || !texts.thruster_events.empty()) settings.thruster_events.clear();
  for (const std::string& text : texts.thruster_events) {
    const auto event = suave::model::parse_thruster(text);
    if (!event) return Error{"--thruster: " + event.error()};
    settings.thruster_events.push_back(*event);
  }
  return check(settings);
}

// A file that --fit has written, or the vehicle alone.
Expected<suave::model::VehicleTraits> read_vehicle(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return Error{text.error()};
  Json json = parse_json(*text);
  if (json.is_discarded()) return Error{path + ": it is no JSON"};
  if (json.is_object() && json.contains("vehicle")) json = Json(json["vehicle"]);
  const auto vehicle = study::vehicle_from_json(json);
  if (!vehicle) return Error{path + ": " + vehicle.error()};
  return *vehicle;
}

// The options that differ from the mission as it is.
std::string settings_of_command(const study::SuaveCampaign& campaign) {
  if (!campaign.settings) return "";
  const suave::model::MissionSettings& settings = *campaign.settings;
  const auto plain = settings_of(*campaign.plan);
  std::string text;
  if (settings.visibility_period_s != plain.visibility_period_s)
    text += fmt::format(" --visibility-period {}", settings.visibility_period_s);
  if (settings.visibility_shift_s != plain.visibility_shift_s)
    text += " --visibility-shift " + to_string(settings.visibility_shift_s);
  const suave::model::Range visibility{settings.least_visibility_m, settings.most_visibility_m};
  if (visibility != suave::model::Range{plain.least_visibility_m, plain.most_visibility_m})
    text += " --visibility " + to_string(visibility);
  if (settings.start_y_m) text += " --start=" + to_string(*settings.start_y_m);
  if (settings.time_limit_s != plain.time_limit_s)
    text += fmt::format(" --time-limit {}", settings.time_limit_s);
  if (settings.thruster_events == plain.thruster_events) return text;
  if (settings.thruster_events.empty()) text += " --no-thruster-events";
  for (const auto& event : settings.thruster_events) text += " --thruster " + to_string(event);
  return text;
}

// The command that repeats the campaign.
std::string command_of(const study::SuaveCampaign& campaign, const std::string& vehicle) {
  const std::string mission(campaign.plan->name);
  return fmt::format("culprit study suave {}--managers {} --generation {} --runs {} --seed {}{}{}",
                     mission == "standard" ? "" : "--" + mission + " ",
                     fmt::join(campaign.managers, ","), campaign.generation->name, campaign.runs,
                     campaign.seed, settings_of_command(campaign),
                     vehicle.empty() ? "" : " --vehicle " + vehicle);
}

Expected<study::SuaveCampaign> campaign_of(const SuaveOptions& options) {
  study::SuaveCampaign campaign;
  const auto plan = suave::model::find_mission_plan(options.stress     ? "stress"
                                                    : options.extended ? "extended"
                                                                       : "standard");
  if (!plan) return Error{plan.error()};
  campaign.plan = *plan;
  const auto generation = suave::model::find_generation(options.generation);
  if (!generation) return Error{generation.error()};
  campaign.generation = *generation;
  campaign.managers = options.managers;
  if (campaign.managers.empty()) {
    for (const study::SuaveContender& each : study::suave_contenders())
      campaign.managers.push_back(each.name);
  }
  if (const auto known = study::check_managers(campaign.managers); !known)
    return Error{known.error()};
  campaign.runs = options.runs;
  campaign.seed = options.seed;
  suave::model::MissionSettings settings = settings_of(*campaign.plan);
  if (auto applied = apply(options.settings, settings); !applied) return Error{applied.error()};
  if (settings != settings_of(*campaign.plan)) campaign.settings = std::move(settings);
  if (!options.vehicle.empty()) {
    const auto vehicle = read_vehicle(options.vehicle);
    if (!vehicle) return Error{vehicle.error()};
    campaign.vehicle = *vehicle;
  }
  campaign.version = options.version;
  campaign.command = command_of(campaign, options.vehicle);
  return campaign;
}

int fit(const study::SuaveCampaign& campaign, const SuaveOptions& options) {
  Expected<std::vector<study::FitCampaign>> targets = study::published_targets(options.fit_rows);
  std::vector<std::string> left_out;
  if (!options.fit.empty()) {
    const auto recorded = study::read_recorded(options.fit);
    if (!recorded) return fail(recorded.error(), kUsage);
    study::FitCampaign target{campaign, {}};
    for (const study::RecordedRow& row : recorded->rows)
      target.targets.push_back({row.manager, row.search_s, row.distance_m});
    left_out = recorded->unknown;
    targets = std::vector<study::FitCampaign>{std::move(target)};
  }
  if (!targets) return fail(targets.error(), kUsage);
  const auto fit =
      study::fit_vehicle(std::move(*targets), campaign.vehicle, options.runs, options.jobs,
                         [](const std::string& step) { fmt::print(stderr, "{}\n", step); });
  if (!fit) return fail(fit.error(), kUsage);
  const Json document = {{"fitted_to", options.fit.empty() ? options.fit_rows : options.fit},
                         {"campaign", study::to_json(campaign)},
                         {"left_out", left_out},
                         {"misfit_before", fit->misfit_before},
                         {"misfit", fit->misfit},
                         {"vehicle", study::to_json(fit->vehicle)}};
  const auto written = write_text(options.output.output, to_indented(document) + "\n");
  return written ? kOk : fail(written.error(), kFailed);
}

// Both missions as the paper has them.
int judge_claims(const study::SuaveCampaign& campaign, const SuaveOptions& options) {
  std::vector<study::SuaveResult> results;
  const StopSignals signals;
  for (const char* mission : {"standard", "extended"}) {
    study::SuaveCampaign each = campaign;
    each.plan = *suave::model::find_mission_plan(mission);
    each.managers = {"none", "bt", "metacontrol", "rosa", study::kCulprit};
    Progress progress(0, each.size());
    auto result = run_whole(each, options.jobs, signals, progress,
                            [&](study::RunId id) { return study::play(each, id); });
    progress.end();
    if (!result) return kFailed;
    results.push_back(std::move(*result));
  }
  const auto written =
      options.output.format == "csv"
          ? write_text(
                options.output.output,
                study::claims_csv("", "", study::suave_claims(results.front(), results.back())))
          : write(std::vector{study::suave_claims_table(results.front(), results.back())},
                  options.output);
  return written ? kOk : fail(written.error(), kFailed);
}

int validate(const study::SuaveCampaign& campaign, const SuaveOptions& options) {
  const auto recorded = study::read_recorded(options.validate);
  if (!recorded) return fail(recorded.error(), kUsage);
  const auto validation = study::validate(campaign, *recorded, options.margin_sd, options.jobs);
  const auto written = write(validation, options.output);
  return written ? kOk : fail(written.error(), kFailed);
}

int study_suave(const SuaveOptions& options) {
  const auto campaign = campaign_of(options);
  if (!campaign) return fail(campaign.error(), kUsage);
  if (!options.fit.empty() || !options.fit_rows.empty()) return fit(*campaign, options);
  if (options.claims) return judge_claims(*campaign, options);
  if (!options.validate.empty()) return validate(*campaign, options);
  const auto play = [&](study::RunId id) { return study::play(*campaign, id); };
  const StopSignals signals;
  if (options.shard.is_sharded())
    return fill_shard(*campaign, options.shard, options.jobs, signals, play);
  warn_of_missing_python(options.output.report);
  Progress progress(0, campaign->size());
  const auto result = run_whole(*campaign, options.jobs, signals, progress, play);
  progress.end();
  if (!result) return kFailed;
  const auto written = write(*result, options.output);
  return written ? kOk : fail(written.error(), kFailed);
}

void add_settings(CLI::App& command, SettingTexts& settings) {
  constexpr const char* kGroup =
      "Mission settings (where A..B: another value in each run; A,B,C: these by turns)";
  command
      .add_option("--visibility-period", settings.visibility_period,
                  "Period of the water's visibility, in s (default: 80)")
      ->group(kGroup);
  command
      .add_option(
          "--visibility-shift", settings.visibility_shift,
          "Phase of the visibility at the mission's begin, in s, A..B or A,B,C (default: 0)")
      ->group(kGroup);
  command
      .add_option("--visibility", settings.visibility,
                  "From the dimmest to the clearest, in m (default: 1.25..3.75; 2.5: always)")
      ->group(kGroup);
  auto* thruster =
      command
          .add_option("--thruster", settings.thruster_events,
                      "Instead of the mission's events: 1:fails@35, 3:recovers@0..200; repeatable")
          ->group(kGroup);
  command.add_flag("--no-thruster-events", settings.no_thruster_events, "All thrusters work")
      ->excludes(thruster)
      ->group(kGroup);
  command
      .add_option("--start", settings.start,
                  "Start position across the pipeline, y in m, A..B or A,B,C (default: as fitted)")
      ->group(kGroup);
  command
      .add_option("--time-limit", settings.time_limit,
                  "Time limit of the mission, in s (default: 300)")
      ->group(kGroup);
}

void add_validation(CLI::App& command, SuaveOptions& options) {
  constexpr const char* kGroup = "The model beside recorded runs (the exemplar's CSV files)";
  command
      .add_option("--vehicle", options.vehicle,
                  "The vehicle's constants: what --fit wrote (default: fitted to the paper's rows)")
      ->type_name("FILE")
      ->group(kGroup);
  auto* fit = command
                  .add_option("--fit", options.fit,
                              "Fit the vehicle to these runs, and write it; repeatable")
                  ->type_name("FILE")
                  ->group(kGroup);
  command
      .add_option("--fit-rows", options.fit_rows,
                  "Fit the vehicle to these rows of the paper's table, as none,bt,extended:rosa")
      ->delimiter(',')
      ->excludes(fit)
      ->group(kGroup);
  command
      .add_option("--validate", options.validate,
                  "Compare the model with these runs, which it should not be fitted to; repeatable")
      ->type_name("FILE")
      ->excludes(fit)
      ->group(kGroup);
  command
      .add_option("--margin", options.margin_sd,
                  "Equivalent are means that differ by less than so many recorded sd")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str()
      ->group(kGroup);
}

}  // namespace

void add_study_suave(CLI::App& study, const std::string& version, int& exit_code) {
  auto options = std::make_shared<SuaveOptions>();
  options->version = version;
  CLI::App* command = study.add_subcommand(
      "suave", "The paper's evaluation on SUAVE, with the managers that it compares with");
  auto* extended =
      command->add_flag("--extended", options->extended,
                        "With a battery that runs low (default: the standard mission)");
  command
      ->add_flag("--stress", options->stress,
                 "Also kill processes, and hang the mode manager (not in the paper)")
      ->excludes(extended);
  command
      ->add_flag("--claims", options->claims,
                 "Each claim of the paper on both missions, with a test and a verdict")
      ->excludes(extended);
  command
      ->add_option("--managers", options->managers,
                   "Only these of none, random, bt, metacontrol, rosa, rebet, rebet-ucb, "
                   "rebet-greedy, rebet-random, bandit, ac-ros, vogel, ghahremani, culprit")
      ->delimiter(',');
  command->add_option("--generation", options->generation, "Which SUAVE: era (published) or new")
      ->capture_default_str();
  command->add_option("--runs", options->runs, "Number of runs of each manager")
      ->check(CLI::Range(1U, 1'000'000U))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of all random numbers")->capture_default_str();
  command->add_option("--jobs", options->jobs, "Threads; the results do not depend on it")
      ->check(CLI::Range(1U, 1024U));
  add_settings(*command, options->settings);
  add_validation(*command, *options);
  options->shard.add_to(*command);
  options->output.add_suave_to(*command);
  command->callback([options, &exit_code] { exit_code = study_suave(*options); });
}

}  // namespace culprit::lab
