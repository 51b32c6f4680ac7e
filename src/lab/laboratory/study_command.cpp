// culprit study: campaigns over an exemplar.
#include <algorithm>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/text_file.h"
#include "laboratory/commands.h"
#include "laboratory/live_campaign.h"
#include "laboratory/study_output.h"
#include "laboratory/study_runs.h"
#include "laboratory/sunset_live_run.h"
#include "shards/merge.h"
#include "study/run_record.h"
#include "sunset_study/study.h"
#include "sunset_study/sweep.h"

namespace culprit::lab {
namespace {

struct StudyOptions {
  bool ablation = false;
  bool robustness = false;
  bool learning = false;
  bool sweep = false;
  std::vector<std::string> planners = {"paper"};
  std::vector<std::string> objectives = {"balanced"};
  std::string profile = "paper";
  std::vector<std::string> detectors = {"own"};
  std::string rules{};
  std::uint32_t runs = 162;
  std::uint32_t experiments = 400;  // what the designer believed is outweighed then
  std::uint32_t repetitions = 20;
  std::uint64_t seed = 1;
  std::optional<unsigned> jobs_asked;
  ShardOptions shard;
  bool live = false;
  std::optional<std::uint32_t> single_run;
  std::string switches = "DCS";
  bool misspecified = false;
  std::string version;
  StudyOutput output;

  bool has_everything() const { return !ablation && !robustness && !learning; }
  bool has_ablation() const { return ablation || has_everything(); }
  bool has_robustness() const { return robustness || has_everything(); }
  bool has_learning() const { return learning || (has_everything() && !live); }
  // A live robot keeps nearly a processor busy.
  unsigned jobs() const {
    const unsigned processors = std::max(1U, std::thread::hardware_concurrency());
    return jobs_asked.value_or(live ? std::max(1U, processors / 2) : processors);
  }
};

// "D-S"
Expected<PaperSwitches> parse_switches(const std::string& text) {
  const auto is = [&](std::size_t place, char letter) {
    return text.size() == 3 && (text[place] == letter || text[place] == '-');
  };
  if (!is(0, 'D') || !is(1, 'C') || !is(2, 'S'))
    return Error{"'" + text + "' is no configuration: write DCS with a - for what is off, as D-S"};
  return PaperSwitches{text[0] == 'D', text[1] == 'C', text[2] == 'S'};
}

// As the study calls them: bayes once for each objective.
std::vector<std::string> planners_of(const StudyOptions& options) {
  std::vector<std::string> planners;
  for (const std::string& planner : options.planners) {
    if (planner != "bayes") {
      planners.push_back(planner);
      continue;
    }
    for (const std::string& objective : options.objectives)
      planners.push_back(objective == "balanced" ? planner : planner + ":" + objective);
  }
  return planners;
}

// The profile once for each kind of detectors, as the study calls it.
std::vector<std::string> profiles_of(const StudyOptions& options) {
  std::vector<std::string> profiles;
  for (const std::string& detectors : options.detectors)
    profiles.push_back(detectors == "own" ? options.profile : options.profile + ":" + detectors);
  return profiles;
}

// The rows of the paper's tables, in the paper's order.
void add_rows(const StudyOptions& options, const std::string& profile,
              std::vector<study::Configuration>& rows) {
  using study::Probabilities;
  for (const std::string& planner : planners_of(options)) {
    for (const bool d : {false, true}) {
      for (const bool c : {false, true}) {
        for (const bool s : {false, true}) {
          const bool is_full = d && c && s;
          if (!study::has_switches(planner) && !is_full) continue;
          if (options.has_ablation() || (options.has_robustness() && is_full))
            rows.push_back({{d, c, s}, planner, profile, Probabilities::kIdeal});
        }
      }
    }
    if (options.has_robustness())
      rows.push_back({{}, planner, profile, Probabilities::kMisspecified});
  }
}

// Live, each row is also played on the model of that robot.
std::vector<study::Configuration> rows_of(const StudyOptions& options) {
  std::vector<study::Configuration> rows;
  if (options.live) {
    add_rows(options, std::string(study::kModelOfLiveRobot), rows);
    add_rows(options, std::string(study::kLiveRobot), rows);
    return rows;
  }
  for (const std::string& profile : profiles_of(options)) add_rows(options, profile, rows);
  return rows;
}

std::string command_of(const StudyOptions& options) {
  std::string command = "culprit study sunset";
  if (options.live) command += " --live";
  if (options.ablation) command += " --ablation";
  if (options.robustness) command += " --robustness";
  if (options.sweep) command += " --sweep";
  if (options.learning)
    command += fmt::format(" --learning --experiments {} --repetitions {}", options.experiments,
                           options.repetitions);
  for (const std::string& planner : options.planners) command += " --planner " + planner;
  if (options.objectives != StudyOptions().objectives)
    command += fmt::format(" --objective {}", fmt::join(options.objectives, ","));
  if (options.detectors != StudyOptions().detectors)
    command += fmt::format(" --detectors {}", fmt::join(options.detectors, ","));
  if (!options.live) command += fmt::format(" --profile {}", options.profile);
  if (!options.rules.empty()) command += " --rules " + options.rules;
  return command + fmt::format(" --runs {} --seed {}", options.runs, options.seed);
}

// Who learns: the first of the planners that can, or else the paper's.
std::string learner_of(const StudyOptions& options) {
  const std::vector<std::string> planners = planners_of(options);
  const auto found = std::find_if(planners.begin(), planners.end(), study::can_learn);
  return found == planners.end() ? "paper" : *found;
}

// `progress` has what comes before it behind it.
Expected<std::vector<study::LearningCurve>> learn(const StudyOptions& options, Progress& progress,
                                                  std::uint64_t before) {
  auto study = study::SunsetStudy::make({{{},
                                          learner_of(options),
                                          profiles_of(options).front(),
                                          study::Probabilities::kMisspecified}},
                                        options.seed);
  if (!study) return Error{study.error()};
  return study->learn(options.experiments, options.repetitions,
                      [&](std::uint64_t done) { progress.show(before + done); });
}

// The row of the paper's full configuration, or the first if there is none.
std::uint32_t told_row(const study::Campaign& campaign) {
  const auto row = std::find_if(campaign.rows.begin(), campaign.rows.end(),
                                [](const auto& each) { return each.switches == PaperSwitches{}; });
  return row == campaign.rows.end() ? 0 : static_cast<std::uint32_t>(row - campaign.rows.begin());
}

// Each scenario once, for the report.
std::vector<study::Timeline> timelines(const study::SunsetStudy& study,
                                       const study::Campaign& campaign,
                                       const StudyOptions& options) {
  std::vector<study::Timeline> told;
  if (!options.output.report.is_wanted()) return told;
  const auto scenarios = static_cast<std::uint32_t>(sunset::scenarios().size());
  for (std::uint32_t run = 0; run < std::min(campaign.runs, scenarios); ++run)
    told.push_back(study.explain({told_row(campaign), run}));
  return told;
}

template <class Play>
int run_campaign(const study::SunsetStudy& study, const study::Campaign& campaign,
                 const StudyOptions& options, const StopSignals& signals, Play play) {
  warn_of_missing_python(options.output.report);
  const std::uint64_t learned =
      options.has_learning() ? std::uint64_t{options.experiments} * options.repetitions : 0;
  Progress progress(0, campaign.size() + learned);
  auto result = run_whole(campaign, options.jobs(), signals, progress, play);
  if (!result) return kFailed;
  study::Findings findings{std::move(*result), {}, timelines(study, campaign, options)};
  if (options.has_learning()) {
    auto curves = learn(options, progress, campaign.size());
    if (!curves) return fail(curves.error(), kUsage);
    findings.learning = std::move(*curves);
  }
  progress.end();
  const auto written = write(findings, options.output);
  return written ? kOk : fail(written.error(), kFailed);
}

// Which row a single run is of.
Expected<study::Configuration> row_of(const StudyOptions& options, const std::string& profile) {
  const auto switches = parse_switches(options.switches);
  if (!switches) return Error{switches.error()};
  return study::Configuration{
      *switches, planners_of(options).front(), profile,
      options.misspecified ? study::Probabilities::kMisspecified : study::Probabilities::kIdeal};
}

// One run on the live robot, as a JSON object: what the campaign starts a process for.
int play_one_live(const StudyOptions& options) {
  auto row = row_of(options, std::string(study::kLiveRobot));
  if (!row) return fail(row.error(), kUsage);
  const auto study = study::SunsetStudy::make({std::move(*row)}, options.seed);
  if (!study) return fail(study.error(), kUsage);
  const StopSignals signals;
  const auto metrics = play_live(*study, {0, *options.single_run}, signals.stopped());
  if (!metrics) return fail(metrics.error(), kFailed);
  const auto json = study::to_json(*metrics);
  if (!json) return fail(json.error(), kFailed);
  const auto written = write_text(options.output.output, json->dump(2) + "\n");
  return written ? kOk : fail(written.error(), kFailed);
}

int explain(const StudyOptions& options) {
  const auto wanted = row_of(options, profiles_of(options).front());
  if (!wanted) return fail(wanted.error(), kUsage);
  // The same row as in the campaign, so that it is the same run.
  std::vector<study::Configuration> rows = rows_of(options);
  const auto row = std::find(rows.begin(), rows.end(), *wanted);
  if (row == rows.end()) return fail("the campaign has no such configuration", kUsage);
  const auto index = static_cast<std::uint32_t>(row - rows.begin());
  const auto study = study::SunsetStudy::make(std::move(rows), options.seed);
  if (!study) return fail(study.error(), kUsage);
  fmt::print("{}", timeline_text(study->explain({index, *options.single_run})));
  return kOk;
}

// The unpublished constants, varied.
int sweep(const StudyOptions& options) {
  const study::SweepCampaign campaign{options.planners, options.profile, options.runs,
                                      options.seed};
  warn_of_missing_python(options.output.report);
  const StopSignals signals;
  Progress progress(0, study::sweep_size(campaign));
  const auto points = study::sweep(campaign, options.jobs(), [&](std::uint64_t done) {
    progress.show(done);
    return !signals.stopped();
  });
  progress.end();
  if (!points) return fail(points.error(), kUsage);
  if (signals.stopped()) return fail("interrupted; nothing is written", kFailed);
  const auto written = write_sweep(
      study::sweep_tables(*points, campaign),
      study::sweep_json(*points, campaign, command_of(options), options.version), options.output);
  return written ? kOk : fail(written.error(), kFailed);
}

int study_sunset(const StudyOptions& options) {
  if (options.sweep) return sweep(options);
  if (options.single_run) return options.live ? play_one_live(options) : explain(options);
  if (options.live && options.learning)
    return fail("--learning goes through hundreds of runs: it is for the model", kUsage);
  if (options.shard.is_sharded() && options.learning)
    return fail("learning goes from run to run and cannot be spread over shards", kUsage);
  study::Campaign campaign{rows_of(options), options.runs, options.seed, options.version,
                           command_of(options)};
  study::Variation variation;
  if (!options.rules.empty()) {
    auto text = read_text(options.rules);
    if (!text) return fail(text.error());
    variation.rules = std::move(*text);
  }
  const auto study = study::SunsetStudy::make(campaign.rows, campaign.seed, variation);
  if (!study) return fail(study.error(), kUsage);
  const StopSignals signals;
  const auto work_off = [&](const auto& play) {
    if (!options.shard.is_sharded()) return run_campaign(*study, campaign, options, signals, play);
    return fill_shard(campaign, options.shard, options.jobs(), signals, play);
  };
  if (!options.live) return work_off([&](study::RunId id) { return study->run(id); });
  const auto live = LiveCampaign::open();
  if (!live) return fail(live.error(), kFailed);
  return work_off([&](study::RunId id) -> Expected<study::RunMetrics> {
    const study::Configuration& row = campaign.rows[id.row];
    if (row.profile != study::kLiveRobot) return study->run(id);
    return live->play(row, id.run, study->seed_of(id), signals.stopped());
  });
}

int merge(const std::vector<std::string>& files, const StudyOutput& output) {
  auto merged = study::merge_files(files);
  if (!merged) return fail(merged.error(), kFailed);
  auto* sunset = std::get_if<study::CampaignResult>(&*merged);
  const auto written = sunset != nullptr
                           ? write(study::Findings{std::move(*sunset), {}, {}}, output)
                           : write(std::get<study::SuaveResult>(*merged), output);
  return written ? kOk : fail(written.error(), kFailed);
}

// The compared planners and detectors, and the robot.
void add_comparison(CLI::App* command, const std::shared_ptr<StudyOptions>& options) {
  command->add_flag("--ablation", options->ablation, "Eight configurations of D, C and S");
  command->add_flag("--robustness", options->robustness,
                    "Compare success probabilities that are 20 % off with ideal ones");
  command->add_flag(
      "--learning", options->learning,
      "Show the learned rates of each strategy; uses the first learning planner (paper, bayes)");
  command->add_flag("--sweep", options->sweep,
                    "Vary the constants that the paper leaves open, and rank the configurations at "
                    "each point; --runs 54 plays each scenario three times");
  command
      ->add_option(
          "--planner", options->planners,
          "paper (Algorithm 1 as meant), reference (the authors' public code with its slips), "
          "bayes (culprit's own); bt, metacontrol, rosa (others': one failure and one strategy at "
          "a time), rebet, rebet-ucb, rebet-greedy, rebet-random, ac-ros, vogel, ghahremani "
          "(others': each failure for itself); bandit (Thompson sampling, no graph), random; "
          "oracle "
          "(knows each fault and its remedy at once: a bound); several, one after the other")
      ->capture_default_str();
  command
      ->add_option("--objective", options->objectives,
                   "Cost that bayes minimizes; several, one after the other")
      ->delimiter(',')
      ->check(CLI::IsMember({"balanced", "downtime", "adaptations", "redeployments"}))
      ->capture_default_str();
  auto* live = command->add_flag(
      "--live", options->live,
      "On the live robot (its processes, started for each run), with its model beside it: half a "
      "minute a run");
  command
      ->add_option("--profile", options->profile,
                   "Which SUNSET: paper, head, october (versions of the exemplar) or live (ours)")
      ->capture_default_str()
      ->excludes(live);
  command
      ->add_option("--rules", options->rules,
                   "Rules for all planners instead of the built-in ones, without INCLUDE")
      ->type_name("FILE")
      ->excludes(live);
  command
      ->add_option("--detectors", options->detectors,
                   "Detection of outages: own (the profile's: SUNSET's monitoring as in the paper; "
                   "of live, age), age (three messages missed), phi (a silence out of its rhythm) "
                   "or known (the fault at once: a bound); several, one after the other")
      ->delimiter(',')
      ->check(CLI::IsMember({"own", "age", "phi", "known"}))
      ->capture_default_str()
      ->excludes(live);
}

void add_sunset(CLI::App& study, const std::string& version, int& exit_code) {
  auto options = std::make_shared<StudyOptions>();
  options->version = version;
  CLI::App* command = study.add_subcommand(
      "sunset", "The paper's evaluation on SUNSET, in virtual time; without a choice, all of it");
  add_comparison(command, options);
  command->add_option("--runs", options->runs, "Number of runs of each configuration")
      ->check(CLI::Range(1U, 1'000'000'000U))
      ->capture_default_str();
  command
      ->add_option("--experiments", options->experiments,
                   "Experiments of each learning series; the paper has 162")
      ->check(CLI::Range(1U, 1'000'000U))
      ->capture_default_str();
  command->add_option("--repetitions", options->repetitions, "Number of learning series")
      ->check(CLI::Range(1U, 1'000'000U))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of all random numbers")->capture_default_str();
  command
      ->add_option("--jobs", options->jobs_asked,
                   "Threads; the results do not depend on it. With --live, robots at once, each in "
                   "a ROS domain of its own (default: one for two processors)")
      ->check(CLI::Range(1U, 1024U));
  options->shard.add_to(*command);
  command->get_option("--shard-file")->excludes("--rules");
  auto* run = command->add_option(
      "--run", options->single_run,
      "With --explain: the run to explain, from 0. With --live: the run to play, metrics as JSON");
  command->add_flag("--explain")
      ->description("Explain the decisions of the run that --run names")
      ->needs(run)
      ->excludes("--live");
  command->add_option("--switches", options->switches, "With --run: the configuration")
      ->capture_default_str();
  command
      ->add_flag("--misspecified", options->misspecified,
                 "With --run: the configuration whose success probabilities are 20 % off")
      ->needs(run);
  options->output.add_to(*command);
  command->callback([options, &exit_code] { exit_code = study_sunset(*options); });
}

void add_merge(CLI::App& study, int& exit_code) {
  struct MergeOptions {
    std::vector<std::string> files;
    StudyOutput output;
  };
  auto options = std::make_shared<MergeOptions>();
  CLI::App* command = study.add_subcommand("merge", "Merge the shards of a campaign, of any study");
  command->add_option("FILES", options->files, "All shard files")->type_name("FILE")->required();
  options->output.add_to(*command);
  command->callback([options, &exit_code] { exit_code = merge(options->files, options->output); });
}

}  // namespace

void add_study(CLI::App& app, const std::string& version, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "study", "Campaigns over an exemplar: metrics, statistics and tables beside the paper's");
  command->require_subcommand(1);
  add_sunset(*command, version, exit_code);
  add_study_suave(*command, version, exit_code);
  add_study_rca(*command, version, exit_code);
  add_study_fleet(*command, exit_code);
  add_study_rover(*command, exit_code);
  add_merge(*command, exit_code);
  add_study_all(*command, version, exit_code);
}

}  // namespace culprit::lab
