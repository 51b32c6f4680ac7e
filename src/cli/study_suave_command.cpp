// culprit study suave: the paper's second evaluation, with the managers that it compares with.
#include "cli/study_suave_command.h"

#include <algorithm>
#include <memory>
#include <thread>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/text_file.h"
#include "study/suave/html_report.h"
#include "study/suave/report.h"
#include "study/tables/render.h"

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
  std::string format = "text";
  std::string output;  // empty: the standard output
  std::string html;    // a report; empty: none
  std::string version;
};

int fail(const std::string& what, int code) {
  fmt::print(stderr, "culprit: {}\n", what);
  return code;
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
  std::string known;
  std::vector<std::string> all;
  for (const study::SuaveContender& each : study::suave_contenders()) {
    known += (known.empty() ? "" : ", ") + each.name;
    all.push_back(each.name);
  }
  for (const std::string& manager : options.managers) {
    if (std::find(all.begin(), all.end(), manager) == all.end())
      return Error{"there is no manager '" + manager + "'; there are " + known};
  }
  campaign.managers = options.managers.empty() ? all : options.managers;
  campaign.runs = options.runs;
  campaign.seed = options.seed;
  return campaign;
}

std::string in_format(const std::string& format, const study::SuaveCampaign& campaign,
                      const std::vector<study::SuaveRow>& rows) {
  if (format == "json") return study::suave_json(campaign, rows);
  std::string out;
  for (const study::Table& table : study::suave_tables(campaign, rows)) {
    out += out.empty() ? "" : "\n";
    out += format == "markdown" ? study::markdown(table)
           : format == "latex"  ? study::latex(table)
                                : study::text(table);
  }
  return out;
}

// What makes the campaign again.
std::string command_of(const study::SuaveCampaign& campaign) {
  const std::string mission(campaign.plan->name);
  return fmt::format("culprit study suave {}--managers {} --generation {} --runs {} --seed {}",
                     mission == "standard" ? "" : "--" + mission + " ",
                     fmt::join(campaign.managers, ","), campaign.generation->name, campaign.runs,
                     campaign.seed);
}

int study_suave(const SuaveOptions& options) {
  const auto campaign = campaign_of(options);
  if (!campaign) return fail(campaign.error(), kUsage);
  const StopSignals signals;
  const auto rows =
      study::run_campaign(*campaign, options.jobs, [&] { return signals.stopped().load(); });
  if (!rows) return fail("interrupted; nothing is written", kFailed);
  const std::string text = in_format(options.format, *campaign, *rows);
  if (auto written = write_text(options.output, text); !written)
    return fail(written.error(), kFailed);
  if (options.html.empty()) return kOk;
  const auto written =
      write_text(options.html, study::suave_html(*campaign, *rows, study::first_tracks(*campaign),
                                                 command_of(*campaign), options.version));
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
  command
      ->add_option("--format", options->format,
                   "text (tables, ours beside the paper's), markdown, latex or json")
      ->check(CLI::IsMember({"text", "markdown", "latex", "json"}))
      ->capture_default_str();
  command->add_flag_callback(
      "--json", [options] { options->format = "json"; }, "The same as --format json");
  command->add_option("-o,--output", options->output, "Write there (default: the terminal)");
  command->add_option(
      "--html", options->html,
      "Also write a report there: tables, and the first run of each manager, moving");
  command->callback([options, &exit_code] { exit_code = study_suave(*options); });
}

}  // namespace culprit::cli
