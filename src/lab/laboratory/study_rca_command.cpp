// culprit study rca: a benchmark of root-cause analysis on random robots.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/text_file.h"
#include "exemplar_cases/exemplar_cases.h"
#include "laboratory/commands.h"
#include "laboratory/study_output.h"
#include "rca_study/export.h"
#include "rca_study/learning_report.h"
#include "rca_study/rca_report.h"
#include "rca_study/regret.h"
#include "rca_study/repair_process.h"
#include "rca_study/scenario_json.h"
#include "study/tables/render.h"
#include "terminal/console.h"
#include "terminal/progress.h"

namespace culprit::lab {
namespace {

using study::rca::RangeOfSeconds;
using study::rca::RcaCampaign;
using study::rca::RcaFactors;
using study::rca::RcaRow;
using study::rca::RepairProcess;
using study::rca::Times;

constexpr std::size_t kRoverCasesOfEachFault = 1;
constexpr std::size_t kSunsetCasesOfEachFault = 3;

struct RcaOptions {
  std::vector<std::size_t> components = {200};
  std::vector<std::size_t> faults = {3};
  std::vector<double> noise = {0};
  bool cyclic = false;
  bool mixed_levels = false;
  bool flapping = false;
  bool unfixable = false;
  bool ignore = false;
  RcaFactors factors;
  std::vector<std::string> planners;  // none: all
  std::string objective = "balanced";
  std::uint32_t episodes = 100;
  std::uint64_t seed = 1;
  unsigned jobs = std::max(1U, std::thread::hardware_concurrency());
  bool timing = false;
  std::string format = "text";
  std::string output;    // empty: the standard output
  std::string scenario;  // a file; empty: random robots
  std::optional<std::uint32_t> explained;
  std::optional<std::uint32_t> learned;  // faults; nothing: no learning is measured
  double forgetting = 1;
  bool drift = false;
  bool regret = false;
  std::uint32_t systems = 1000;
  bool untold = false;
  ReportOptions report;
  std::string version;
  std::string scenario_output;   // empty: the episodes are played
  std::string cases_output;      // a folder; empty: no cases are exported
  study::rca::CaseExport cases;  // their numbers and the hidden seed

  Times times() const { return timing ? Times::kShown : Times::kLeftOut; }
};

// One file's, or every combination of the options.
Expected<RcaCampaign> campaign_of(const RcaOptions& options) {
  RcaCampaign campaign;
  if (!options.scenario.empty()) {
    const auto text = read_text(options.scenario);
    if (!text) return Error{text.error()};
    auto scenario = study::rca::scenario_from_json(*text);
    if (!scenario) return Error{options.scenario + ": " + scenario.error()};
    campaign.settings = {study::rca::setting_of(*scenario)};
    campaign.scenario = std::move(*scenario);
  }
  for (const std::size_t components : options.components) {
    if (campaign.scenario) break;
    for (const std::size_t faults : options.faults) {
      if (faults > components)
        return Error{fmt::format("{} faults do not fit on {} components: each has its own", faults,
                                 components)};
      for (const double noise : options.noise)
        campaign.settings.push_back({components, faults, noise, options.cyclic,
                                     options.mixed_levels, false, options.flapping,
                                     options.unfixable, options.ignore, options.factors});
    }
  }
  for (const std::string& planner : options.planners) {
    if (const auto complaint = study::rca::complaint_about_planner(planner))
      return Error{"--planner: " + *complaint};
  }
  const bool has_optimum = study::rca::has_optimum(campaign);
  const auto& asked = options.planners;
  if (!has_optimum && std::find(asked.begin(), asked.end(), "optimum") != asked.end())
    return Error{fmt::format(
        "the optimum is only worked out for robots of at most {} components with at most {} faults "
        "and {} subscriptions, all watched, without common causes and false alarms; see "
        "--components, --faults, --unwatched, --common-causes and --false-alarms",
        RepairProcess::kMostComponents, RepairProcess::kMostFaults,
        RepairProcess::kMostSubscriptions)};
  auto all = study::rca::usual_planners();
  if (!has_optimum) std::erase(all, "optimum");
  campaign.planners = asked.empty() ? all : asked;
  campaign.objective = *parse_objective(options.objective);
  campaign.episodes = options.episodes;
  campaign.seed = options.seed;
  campaign.version = options.version;
  return campaign;
}

// The output, and after it the report, if one is wanted.
int write(const RcaOptions& options, const Expected<std::string>& output,
          const std::vector<ReportFile>& report) {
  auto written =
      output ? write_text(options.output, *output) : Expected<void>(Error{output.error()});
  if (written && options.report.is_wanted()) written = make_report("rca", report, options.report);
  return written ? kOk : fail(written.error(), kFailed);
}

int write(const RcaOptions& options, const RcaCampaign& campaign, const std::vector<RcaRow>& rows) {
  const std::string json = study::rca::rca_json(campaign, rows, options.times());
  const std::string csv = study::rca::rca_csv(rows, options.times());
  const std::vector tables = {study::rca::rca_table(campaign, rows, options.times())};
  return write(
      options,
      options.format == "json"  ? json
      : options.format == "csv" ? csv
                                : tables_as(tables, options.format),
      {{"study.json", json}, {"planners.csv", csv}, {"tables.json", study::tables_json(tables)}});
}

int study_regret(const RcaOptions& options) {
  if (options.format == "csv")
    return fail("--regret has no CSV; there are text, markdown, latex and json", kUsage);
  const study::rca::RegretCampaign campaign{options.systems, options.seed, !options.untold};
  const StopSignals signals;
  std::optional<Progress> progress;
  const auto regrets = study::rca::measure_regret(
      campaign, options.jobs,
      [&](std::uint64_t done, std::uint64_t total) {
        if (!progress) progress.emplace(0, total);
        progress->show(done);
        return true;
      },
      [&] { return signals.stopped().load(); });
  progress.reset();
  if (!regrets) return fail("interrupted; nothing is written", kFailed);
  return write(options,
               options.format == "json"
                   ? study::rca::regret_json(campaign, *regrets)
                   : tables_as({study::rca::regret_table(campaign, *regrets)}, options.format),
               {});
}

int study_learning(const RcaOptions& options) {
  study::rca::LearningCampaign campaign;
  campaign.setting = {options.components.front(), options.faults.front(), options.noise.front(),
                      options.cyclic};
  campaign.setting.factors = options.factors;
  campaign.objective = *parse_objective(options.objective);
  campaign.faults = *options.learned;
  campaign.forgetting = options.forgetting;
  campaign.has_drift = options.drift;
  campaign.seed = options.seed;
  warn_of_missing_python(options.report);
  const StopSignals signals;
  const auto result = study::rca::learn(campaign, [&] { return signals.stopped().load(); });
  if (!result) return fail("interrupted; nothing is written", kFailed);
  const std::string command = fmt::format(
      "culprit study rca --learn {} --components {} --faults {} --noise {:g}{}{} --objective {} "
      "--forgetting {:g}{} --seed {}",
      campaign.faults, campaign.setting.components, campaign.setting.faults, campaign.setting.noise,
      options.cyclic ? " --cyclic" : "", study::rca::options_of(options.factors), options.objective,
      campaign.forgetting, options.drift ? " --drift" : "", campaign.seed);
  const std::string json = study::rca::learning_json(campaign, *result, command, options.version);
  return write(options,
               options.format == "json" ? json : study::rca::learning_text(campaign, *result),
               {{"study.json", json}});
}

// Options that were not given: those of the small set of docs/study-rca.md.
void use_small_set(const CLI::App& command, RcaOptions& options) {
  const auto is_given = [&](const char* name) { return command.get_option(name)->count() > 0; };
  if (!is_given("--components")) options.components = {12, 16, 20};
  if (!is_given("--faults")) options.faults = {1, 2, 3};
  RcaFactors& factors = options.factors;
  if (!is_given("--detector-latency")) factors.detector_latency_s = {0, 3};
  if (!is_given("--unwatched")) factors.unwatched = 0.2;
  if (!is_given("--hidden")) factors.hidden = 0.1;
  if (!is_given("--false-alarms")) factors.false_alarms = 0.5;
}

// As a line that makes the public cases.
std::string command_of(const RcaOptions& options) {
  const auto flag = [](bool is_set, const char* name) { return is_set ? name : ""; };
  return fmt::format(
      "culprit {}: `culprit-lab study rca --export-cases DIR --cases {} --components {} --faults "
      "{} --noise {:g}{}{}{}{}{}{} --objective {} --seed {}`",
      options.version, options.cases.cases, fmt::join(options.components, ","),
      fmt::join(options.faults, ","), fmt::join(options.noise, ","),
      flag(options.cyclic, " --cyclic"), flag(options.mixed_levels, " --mixed-levels"),
      flag(options.flapping, " --flapping"), flag(options.unfixable, " --unfixable"),
      flag(options.ignore, " --ignore"), study::rca::options_of(options.factors), options.objective,
      options.seed);
}

study::rca::CaseExport::Others exemplar_cases(std::uint64_t seed, study::Faults faults) {
  return {{"rover", study::rover_cases(seed, kRoverCasesOfEachFault, faults)},
          {"sunset", study::sunset_cases(seed, kSunsetCasesOfEachFault, faults)}};
}

int export_cases(const RcaOptions& options, const RcaCampaign& campaign) {
  namespace fs = std::filesystem;
  study::rca::CaseExport wanted = options.cases;
  wanted.settings = campaign.settings;
  wanted.objective = campaign.objective;
  wanted.seed = options.seed;
  wanted.command = command_of(options);
  if (wanted.hidden_seed == wanted.seed)
    return fail("--hidden-seed is the seed of the public cases; choose a random 64-bit number",
                kUsage);
  const fs::path folder = options.cases_output;
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_empty(folder, error))
    return fail(fmt::format("{}: is not an empty folder; choose a new one", folder.string()),
                kUsage);
  wanted.others = exemplar_cases(wanted.seed, study::Faults::kEach);
  if (wanted.hidden_seed)
    wanted.hidden_others = exemplar_cases(*wanted.hidden_seed, study::Faults::kDrawn);
  const StopSignals signals;
  std::optional<Progress> progress;
  const auto written = study::rca::export_cases(
      wanted,
      [&](const std::string& path, const std::string& text) -> Expected<void> {
        const fs::path file = folder / path;
        if (fs::create_directories(file.parent_path(), error); error)
          return Error{fmt::format("{}: {}", file.parent_path().string(), error.message())};
        return write_text(file.string(), text);
      },
      [&](std::uint64_t done, std::uint64_t total) {
        if (!progress) progress.emplace(0, total);
        progress->show(done);
        return !signals.stopped();
      });
  progress.reset();
  if (written) return kOk;
  return fail(fmt::format("{} ({} is incomplete)", written.error(), folder.string()), kFailed);
}

template <class T>
T value_or_usage_error(const std::string& option, const Expected<T>& read) {
  if (!read) throw CLI::ValidationError(option, read.error());
  return *read;
}

void add_range(CLI::App& command, const std::string& name, RangeOfSeconds& range,
               const std::string& usual, const std::string& help) {
  command
      .add_option_function<std::string>(
          name,
          [name, &range](const std::string& text) {
            range = value_or_usage_error(name, study::rca::parse_range(text));
          },
          help)
      ->type_name("RANGE")
      ->default_str(usual);
}

void add_share(CLI::App& command, const std::string& name, double& share, double most,
               const std::string& usual, const std::string& help) {
  command
      .add_option_function<std::string>(
          name,
          [name, &share, most](const std::string& text) {
            share = value_or_usage_error(name, study::rca::parse_share(text, most));
          },
          help)
      ->type_name("SHARE")
      ->default_str(usual);
}

// The properties that differ from robot to robot (rca_study/factors.h).
void add_factors(CLI::App& command, RcaFactors& factors) {
  add_range(command, "--detector-latency", factors.detector_latency_s, "0..0.4s",
            "Time until a detector shows a change");
  command.add_flag("--stated,!--not-stated", factors.states_latency,
                   "Impacts of strategies include the latency of the detector");
  add_share(command, "--pass", factors.pass, 1, "90%",
            "Probability that a subscription passes failures on");
  add_range(command, "--delay", factors.delay_s, "0.1..0.8s",
            "Time until a subscription passes a failure on");
  add_share(command, "--unwatched", factors.unwatched, RcaFactors::kMostUnwatched, "0%",
            "Share of components without a rule");
  add_share(command, "--hidden", factors.hidden, 1, "0%",
            "Share of true dependencies that the graph does not show");
  command
      .add_option("--common-causes", factors.common_causes,
                  "Faults outside the robot, each of which hits two components for a while")
      ->check(CLI::Range(std::size_t{0}, RcaFactors::kMostCommonCauses))
      ->capture_default_str();
  command
      .add_option("--false-alarms", factors.false_alarms,
                  "False alarms of each detector per minute, each 1 to 5 s long")
      ->check(CLI::Range(0.0, RcaFactors::kMostFalseAlarms))
      ->capture_default_str();
  command
      .add_option(
          "--faults-before", factors.faults_before,
          "Other faults of the same robot before each episode; managers keep the times that "
          "they learn from these")
      ->check(CLI::Range(std::size_t{0}, RcaFactors::kMostFaultsBefore))
      ->capture_default_str();
}

// Options of the public benchmark (rca_study/export.h).
void add_cases(CLI::App& command, RcaOptions& options) {
  auto* output =
      command
          .add_option("--export-cases", options.cases_output,
                      "Write cases for other methods there, and play nothing (docs/study-rca.md)")
          ->type_name("DIR");
  for (const std::string other :
       {"--scenario", "--write-scenario", "--explain", "--planner", "--faults-before"})
    output->excludes(other);
  command.add_option("--cases", options.cases.cases, "Number of public cases")
      ->check(CLI::Range(std::size_t{1}, study::rca::CaseExport::kMostCases))
      ->capture_default_str()
      ->needs(output);
  auto* hidden = command
                     .add_option("--hidden-seed", options.cases.hidden_seed,
                                 "Also write hidden cases, of this seed; keep it secret")
                     ->needs(output);
  command.add_option("--hidden-cases", options.cases.hidden_cases, "Number of hidden cases")
      ->check(CLI::Range(std::size_t{1}, study::rca::CaseExport::kMostCases))
      ->capture_default_str()
      ->needs(hidden);
}

int study_rca(const RcaOptions& options) {
  if (options.learned) return study_learning(options);
  if (options.regret) return study_regret(options);
  const auto campaign = campaign_of(options);
  if (!campaign) return fail(campaign.error(), kUsage);
  if (!options.cases_output.empty()) return export_cases(options, *campaign);
  if (!options.scenario_output.empty()) {
    const auto first = study::rca::scenario_of(*campaign, campaign->settings.front(), 0);
    const auto written = write_text(options.scenario_output, study::rca::to_json(first));
    return written ? kOk : fail(written.error(), kFailed);
  }
  if (options.explained) {
    for (std::uint32_t p = 0; p < campaign->planners.size(); ++p) {
      const auto run = study::rca::single_run(*campaign, {p, *options.explained});
      fmt::print("{}\n{}\n", campaign->planners[p], study::rca::tell(*run));
    }
    return kOk;
  }
  warn_of_missing_python(options.report);
  const StopSignals signals;
  std::optional<Progress> progress;
  const auto rows = study::rca::run_campaign(*campaign, options.jobs,
                                             [&](std::uint64_t done, std::uint64_t total) {
                                               if (!progress) progress.emplace(0, total);
                                               progress->show(done);
                                               return !signals.stopped();
                                             });
  progress.reset();
  if (!rows) return fail("interrupted; nothing is written", kFailed);
  return write(options, *campaign, *rows);
}

}  // namespace

namespace {

const std::vector<std::string> kFactors = {
    "--detector-latency", "--stated",        "--pass",         "--delay",        "--unwatched",
    "--hidden",           "--common-causes", "--false-alarms", "--faults-before"};

void add_random_robots(CLI::App* command, const std::shared_ptr<RcaOptions>& options) {
  command->add_option("--components", options->components, "Sizes of the robots")
      ->delimiter(',')
      ->check(CLI::Range(std::size_t{2}, std::size_t{10'000}))
      ->capture_default_str();
  command->add_option("--faults", options->faults, "Number of faults at once")
      ->delimiter(',')
      ->check(CLI::Range(std::size_t{1}, std::size_t{10}))
      ->capture_default_str();
  command
      ->add_option("--noise", options->noise,
                   "The probability that a detector's reading is wrong, either way")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 0.4))
      ->capture_default_str();
  command->add_flag("--cyclic", options->cyclic, "Add feedback topics, for feedback loops");
  command->add_flag("--mixed-levels", options->mixed_levels,
                    "Each rule's criticality is any (default: all are ERROR)");
  command->add_flag("--flapping", options->flapping, "Every fault comes and goes");
  command->add_flag("--unfixable", options->unfixable,
                    "No strategy of the rules repairs one of the faults");
  command->add_flag("--ignore", options->ignore,
                    "The rules IGNORE the infrastructure topics, as a user's would");
  add_factors(*command, options->factors);
}

// Which planners play which scenario.
void add_play(CLI::App* command, const std::shared_ptr<RcaOptions>& options) {
  command
      ->add_option("--planner", options->planners,
                   fmt::format("Only these of {}; patient:2s waits 2 s instead of 3.4 s; without a "
                               "choice, all but patient to ghahremani",
                               fmt::join(study::rca::planner_names(), ", ")))
      ->delimiter(',');
  auto* scenario = command
                       ->add_option("--scenario", options->scenario,
                                    "Play this scenario (docs/study-rca.md), with other luck in "
                                    "each episode, instead of random ones")
                       ->type_name("FILE");
  for (const std::string random : {"--components", "--faults", "--noise", "--cyclic",
                                   "--mixed-levels", "--flapping", "--unfixable", "--ignore"})
    scenario->excludes(random);
  for (const std::string& factor : kFactors) scenario->excludes(factor);
  command
      ->add_option("--write-scenario", options->scenario_output,
                   "Write the first episode's scenario there, and play nothing")
      ->type_name("FILE");
  command->add_option("--explain", options->explained,
                      "Explain this episode, from 0, with each planner");
  add_cases(*command, *options);
}

void add_learning_and_regret(CLI::App* command, const std::shared_ptr<RcaOptions>& options) {
  auto* learn = command
                    ->add_option("--learn", options->learned,
                                 "Faults that bayes learns from on one robot, before its accuracy "
                                 "is measured on as many or more")
                    ->check(CLI::Range(1U, 1'000'000U))
                    ->excludes("--scenario");
  // It counts every rule as that of the component with its number, and every effect as one that
  // illness came to.
  for (const std::string factor : {"--unwatched", "--common-causes", "--false-alarms"})
    learn->excludes(factor);
  command
      ->add_option("--forgetting", options->forgetting,
                   "Discount factor per outcome, as of culprit run")
      ->check(CLI::Range(0.5, 1.0))
      ->capture_default_str()
      ->needs(learn);
  command
      ->add_flag("--drift", options->drift, "Success rates change in the last quarter of learning")
      ->needs(learn);
  auto* regret = command->add_flag(
      "--regret", options->regret,
      "Measure bayes' regret for each objective, on random robots of up to four components");
  regret->excludes("--scenario")->excludes(learn);
  for (CLI::Option* other : {learn, regret}) other->excludes("--export-cases");
  for (const std::string& factor : kFactors) regret->excludes(factor);
  command->add_option("--systems", options->systems, "Number of robots")
      ->check(CLI::Range(1U, 1'000'000U))
      ->capture_default_str()
      ->needs(regret);
  command
      ->add_flag("--untold", options->untold,
                 "Use robots that differ from the rules, as those of the benchmark do")
      ->needs(regret);
}

}  // namespace

void add_study_rca(CLI::App& study, const std::string& version, int& exit_code) {
  auto options = std::make_shared<RcaOptions>();
  options->version = version;
  CLI::App* command = study.add_subcommand(
      "rca", "A benchmark of root-cause analysis: random robots with several faults at once");
  add_random_robots(command, options);
  add_play(command, options);
  add_learning_and_regret(command, options);
  command->add_option("--objective", options->objective, "Cost that the bayes planner minimizes")
      ->check(CLI::IsMember({"balanced", "downtime", "adaptations", "redeployments"}))
      ->capture_default_str();
  command->add_option("--episodes", options->episodes, "Episodes of each setting and planner")
      ->check(CLI::Range(1U, 1'000'000U))
      ->capture_default_str()
      ->excludes("--export-cases");
  command->add_option("--seed", options->seed, "Seed of all random numbers")->capture_default_str();
  command->add_option("--jobs", options->jobs, "Threads; the results do not depend on it")
      ->check(CLI::Range(1U, 1024U));
  command->add_flag("--timing", options->timing,
                    "Also measure the planning time on this machine: never the same twice");
  command->add_option("--format", options->format, "text, markdown, latex, csv or json")
      ->check(CLI::IsMember({"text", "markdown", "latex", "csv", "json"}))
      ->capture_default_str();
  command->add_flag_callback(
      "--json", [options] { options->format = "json"; }, "The same as --format json");
  command->add_option("-o,--output", options->output, "Write there (default: the terminal)")
      ->type_name("FILE");
  options->report.add_to(*command);
  for (const char* report : {"--report", "--html", "--svg"}) {
    for (const char* other : {"--regret", "--export-cases", "--write-scenario", "--explain"})
      command->get_option(report)->excludes(other);
  }
  command->callback([options, command, &exit_code] {
    if (!options->cases_output.empty()) use_small_set(*command, *options);
    exit_code = study_rca(*options);
  });
}

}  // namespace culprit::lab
