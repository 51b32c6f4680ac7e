// culprit study suave: the paper's second evaluation, with the managers that it compares with.
#include "cli/study_suave_command.h"

#include <algorithm>
#include <memory>
#include <thread>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "cli/study_output.h"
#include "cli/study_runs.h"

namespace culprit::cli {
namespace {

struct SuaveOptions {
  bool extended = false;
  bool stress = false;
  std::vector<std::string> managers;  // none: all
  std::string generation = "era";
  std::uint32_t runs = 100;
  std::uint64_t seed = 1;
  unsigned jobs = std::max(1U, std::thread::hardware_concurrency());
  ShardOptions shard;
  StudyOutput output;
  std::string version;
};

// What makes the campaign again.
std::string command_of(const study::SuaveCampaign& campaign) {
  const std::string mission(campaign.plan->name);
  return fmt::format("culprit study suave {}--managers {} --generation {} --runs {} --seed {}",
                     mission == "standard" ? "" : "--" + mission + " ",
                     fmt::join(campaign.managers, ","), campaign.generation->name, campaign.runs,
                     campaign.seed);
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
  campaign.version = options.version;
  campaign.command = command_of(campaign);
  return campaign;
}

int study_suave(const SuaveOptions& options) {
  const auto campaign = campaign_of(options);
  if (!campaign) return fail(campaign.error(), kUsage);
  const auto play = [&](study::RunId id) { return study::play(*campaign, id); };
  if (options.shard.is_sharded()) return fill_shard(*campaign, options.shard, options.jobs, play);
  Progress progress(0, campaign->size());
  const auto result = run_whole(*campaign, options.jobs, progress, play);
  progress.end();
  if (!result) return kFailed;
  const auto written = write(*result, options.output);
  return written ? kOk : fail(written.error(), kFailed);
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
                 "Ours: processes that die and a mode manager that hangs, on top of it")
      ->excludes(extended);
  command
      ->add_option("--managers", options->managers,
                   "Only these of none, random, bt, metacontrol, rosa, culprit")
      ->delimiter(',');
  command->add_option("--generation", options->generation, "Which SUAVE: era (published) or new")
      ->capture_default_str();
  command->add_option("--runs", options->runs, "Of each manager")
      ->check(CLI::Range(1U, 1'000'000U))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Of all that is left to chance")
      ->capture_default_str();
  command->add_option("--jobs", options->jobs, "Threads; the results do not depend on it")
      ->check(CLI::Range(1U, 1024U));
  options->shard.add_to(*command);
  options->output.add_suave_to(*command);
  command->callback([options, &exit_code] { exit_code = study_suave(*options); });
}

}  // namespace culprit::cli
