#include <algorithm>
#include <chrono>
#include <memory>
#include <stop_token>
#include <thread>
#include <unistd.h>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "base/amount.h"
#include "base/name_grammar.h"
#include "base/text_file.h"
#include "base/units.h"
#include "cli/commands.h"
#include "cli/diagnostic_report.h"
#include "cli/doctor_bag.h"
#include "cli/finding_text.h"
#include "doctor/doctor_report.h"
#include "doctor/examine.h"
#include "doctor/look.h"
#include "json/json.h"
#include "ros2/options.h"
#include "terminal/console.h"
#include "terminal/progress.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

using doctor::Finding;
using doctor::Gravity;
using doctor::Report;

struct DoctorOptions {
  double seconds = 8;
  bool json = false;
  bool sarif = false;
  bool watch = false;
  std::string save;
  std::string against;
  BagExamination recorded;
};

void print_summary(const Report& report) {
  for (const std::string& each : report.left_out) say(stdout, "{}\n", escape_controls(each));
  if (report.nodes > 0) say(stdout, "{}\n", summary(report));
}

void print_text(const Report& report) {
  for (const Finding& finding : report.findings) print_finding(finding, colour_of(STDOUT_FILENO));
  print_summary(report);
}

int exit_code_of(const Report& report) {
  if (report.findings.empty()) return report.doubtful.empty() ? kOk : kFailed;
  return report.findings.front().gravity == Gravity::kError ? kFailed : kWarnings;
}

void print(const Report& report, const DoctorOptions& options) {
  if (options.sarif)
    say(stdout, "{}\n", to_text(to_sarif(report)));
  else if (options.json)
    say(stdout, "{}\n", to_text(to_json(report)));
  else
    print_text(report);
}

bool is_same(const Finding& a, const Finding& b) {
  return a.code == b.code && a.subject == b.subject;
}

// Prints the findings that are new and those that are gone since the last look.
void print_changes(const Report& before, const Report& now) {
  const auto is_in = [](const Finding& finding, const Report& report) {
    return std::ranges::any_of(report.findings,
                               [&](const Finding& each) { return is_same(each, finding); });
  };
  const Colour colour = colour_of(STDOUT_FILENO);
  const auto time = fmt::localtime(std::time(nullptr));
  for (const Finding& finding : now.findings) {
    if (is_in(finding, before)) continue;
    say(stdout, "{:%H:%M:%S} ", time);
    print_finding(finding, colour);
  }
  const auto is_doubtful = [&](const Finding& finding) {
    return std::ranges::any_of(now.doubtful,
                               [&](const Finding& each) { return is_same(each, finding); });
  };
  for (const Finding& finding : before.findings) {
    if (!is_in(finding, now) && !is_doubtful(finding))
      say(stdout, "{:%H:%M:%S} cleared[{}]: {}\n", time, finding.code,
          escape_controls(finding.subject));
  }
}

// One line of JSON for each look.
void print_again(const Report* before, const Report& now, const DoctorOptions& options) {
  if (options.json) {
    say(stdout, "{}\n", to_line(to_json(now)));
  } else if (before == nullptr) {
    print_text(now);
  } else {
    print_changes(*before, now);
  }
}

int watch_robot(const doctor::LookOptions& how, const doctor::Baseline* healthy,
                const DoctorOptions& options) {
  StopSignals signals;
  std::stop_source stop;
  signals.on_stop([&] { stop.request_stop(); });
  std::optional<Report> last;
  const auto watched = doctor::watch(
      how,
      [&](const doctor::Picture& picture) {
        Report now = report_of(picture, healthy);
        print_again(last ? &*last : nullptr, now, options);
        // An earlier finding that is doubtful now is neither gone nor new.
        for (const Finding& each : last ? last->findings : std::vector<Finding>()) {
          if (std::ranges::any_of(now.doubtful,
                                  [&](const Finding& other) { return is_same(each, other); }))
            now.findings.push_back(each);
        }
        doctor::put_worst_first(now.findings);
        last = std::move(now);
      },
      stop.get_token());
  if (!watched) return fail(watched.error());
  return last ? exit_code_of(*last) : kOk;
}

// Writes the baseline only of a robot that is healthy.
int save_robot(const doctor::Picture& picture, const Report& report, const std::string& file) {
  if (!report.doubtful.empty())
    return fail("this look was not good, so " + file + " was not written; look again");
  if (const int found = exit_code_of(report); found == kFailed)
    return fail("the robot is not healthy, so " + file + " was not written");
  if (const auto written = write_text(file, to_text(baseline_of(picture))); !written)
    return fail(written.error());
  say(stderr, "culprit: {} has {} and {}; compare with it: culprit doctor --against {}\n", file,
      amount_of(baseline_of(picture).nodes.size(), "node"),
      amount_of(picture.flows.size(), "topic"), file);
  return exit_code_of(report);
}

// Shows on a terminal how much of the look is over.
class LookProgress {
 public:
  explicit LookProgress(double time_seconds) {
    if (isatty(STDERR_FILENO) != 1) return;
    drawing_ = std::jthread([time_seconds](std::stop_token stop) {
      constexpr auto kTick = std::chrono::milliseconds(100);
      const auto ticks = static_cast<std::uint64_t>(std::max(time_seconds * 10, 1.0));
      Progress progress(0, ticks);
      for (std::uint64_t done = 0; done < ticks && !stop.stop_requested(); ++done) {
        progress.show(done);
        std::this_thread::sleep_for(kTick);
      }
    });
  }

 private:
  std::jthread drawing_;  // stopped, and joined, at the end
};

int examine_robot(const DoctorOptions& options) {
  const auto participant = ros2::options_from_environment();
  if (!participant) return fail(participant.error(), kUsage);
  std::optional<doctor::Baseline> healthy;
  if (!options.against.empty()) {
    const auto text = read_text(options.against);
    if (!text) return fail(text.error());
    auto baseline = doctor::parse_baseline(*text);
    if (!baseline) return fail(options.against + ": " + baseline.error());
    healthy = std::move(*baseline);
  }
  const bool needs_all = healthy || !options.save.empty();
  const doctor::LookOptions how{
      .participant = *participant,
      .time = from_seconds(options.seconds),
      .extent = needs_all ? doctor::Extent::kEverything : doctor::Extent::kFindings};
  if (options.watch) return watch_robot(how, healthy ? &*healthy : nullptr, options);
  const auto picture = [&] {
    const LookProgress progress(options.seconds);
    return doctor::look(how);
  }();
  if (!picture) return fail(picture.error());
  const Report report = report_of(*picture, healthy ? &*healthy : nullptr);
  print(report, options);
  if (!options.save.empty()) return save_robot(*picture, report, options.save);
  return exit_code_of(report);
}

// Gives the bags, without which the others mean nothing.
CLI::Option* add_bag_options(CLI::App& command, BagExamination& options) {
  CLI::Option* bags = command
                          .add_option("BAG", options.bags,
                                      "Recordings of rosbag2 to examine instead of the live robot")
                          ->type_name("FILE");
  command
      .add_option("--graph", options.graph,
                  "The robot's graph, as culprit graph --json writes it: names the cause")
      ->type_name("FILE")
      ->needs(bags);
  command
      .add_option("--rules", options.rules,
                  "A rule file whose DEPENDENCY and FROM declare the dependencies")
      ->type_name("FILE")
      ->needs(bags);
  command
      .add_option("--policy", options.policy,
                  "Required topics, rates, gaps, coverage and pairs, one a line")
      ->type_name("FILE")
      ->needs(bags);
  command
      .add_option("--fail-on", options.fail_on,
                  "Exit with 1 from this severity on, else with 0 (default: 1 for errors, 3 for "
                  "warnings)")
      ->check(CLI::IsMember({"error", "warning", "never"}))
      ->needs(bags);
  command
      .add_option("--message-path", options.message_path,
                  "Where message definitions are, beside AMENT_PREFIX_PATH")
      ->type_name("FOLDER")
      ->allow_extra_args(false)
      ->needs(bags);
  return bags;
}

}  // namespace

void add_doctor(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = app.add_subcommand(
      "doctor",
      "Find problems of the robot, or in recordings of it, without rules: observes it for some "
      "seconds, changes nothing. Exits with 0 if there are none, with 3 if there are only "
      "warnings");
  CLI::Option* bags = add_bag_options(*command, options->recorded);
  add_seconds(*command, "--for", options->seconds, "How long to look", 0.1, 3600)->excludes(bags);
  auto* json = command->add_flag("--json", options->json, "Print the findings as a JSON document");
  command->add_flag("--sarif", options->sarif, "Print the findings as SARIF 2.1.0")->excludes(json);
  auto* watch = command
                    ->add_flag("--watch", options->watch,
                               "Look again and again, and report new and cleared findings")
                    ->excludes(bags);
  auto* save = command->add_option("--save", options->save, "Save the healthy robot as a baseline")
                   ->type_name("FILE");
  command->add_option("--against", options->against, "Compare with a saved baseline")
      ->type_name("FILE")
      ->excludes(save)
      ->excludes(bags);
  save->excludes(watch)->excludes(bags);
  command->callback([options, &exit_code] {
    options->recorded.json = options->json;
    options->recorded.sarif = options->sarif;
    exit_code =
        options->recorded.bags.empty() ? examine_robot(*options) : examine_bags(options->recorded);
  });
}

}  // namespace culprit::cli
