#include <algorithm>
#include <memory>
#include <unistd.h>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "base/units.h"
#include "cli/commands.h"
#include "cli/diagnostic_report.h"
#include "doctor/examine.h"
#include "doctor/look.h"
#include "ros2/options.h"
#include "terminal/console.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

using doctor::Finding;
using doctor::Gravity;

struct DoctorOptions {
  double seconds = 8;
  bool json = false;
};

std::string_view label(Gravity gravity) { return gravity == Gravity::kError ? "error" : "warning"; }

std::string coloured(Gravity gravity, Colour colour) {
  const std::string text(label(gravity));
  if (colour == Colour::kOff) return text;
  return (gravity == Gravity::kError ? "\033[31m" : "\033[33m") + text + "\033[0m";
}

void print_finding(const Finding& finding, Colour colour) {
  fmt::print("{}[{}]: {}\n", coloured(finding.gravity, colour), finding.code, finding.who);
  fmt::print("  seen:    {}\n  matters: {}\n  do:      {}\n", finding.seen, finding.matters,
             finding.remedy);
}

nlohmann::ordered_json to_json(const Finding& finding) {
  return {{"code", finding.code}, {"severity", label(finding.gravity)}, {"who", finding.who},
          {"seen", finding.seen}, {"matters", finding.matters},         {"remedy", finding.remedy}};
}

std::string count_of(std::ptrdiff_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

void print_text(const doctor::Picture& picture, const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) print_finding(finding, colour_of(STDOUT_FILENO));
  if (picture.nodes.empty()) return;
  const auto errors = std::ranges::count(findings, Gravity::kError, &Finding::gravity);
  const auto warnings = std::ranges::count(findings, Gravity::kWarning, &Finding::gravity);
  fmt::print("{} on domain {}: {}\n", count_of(std::ssize(picture.nodes), "node"), picture.domain,
             findings.empty() ? "nothing is wrong that can be seen from outside"
                              : count_of(errors, "error") + ", " + count_of(warnings, "warning"));
}

int examine_robot(const DoctorOptions& options) {
  const auto participant = ros2::options_from_environment();
  if (!participant) return fail(participant.error());
  const auto picture = doctor::look(*participant, from_seconds(options.seconds));
  if (!picture) return fail(picture.error());
  const std::vector<Finding> findings = doctor::examine(*picture);
  if (options.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const Finding& finding : findings) all.push_back(to_json(finding));
    const nlohmann::ordered_json report = {{"domain", picture->domain},
                                           {"nodes", picture->nodes.size()},
                                           {"findings", std::move(all)}};
    fmt::print("{}\n", to_text(report));
  } else {
    print_text(*picture, findings);
  }
  return findings.empty() ? kOk : kFailed;
}

}  // namespace

void add_doctor(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = app.add_subcommand(
      "doctor",
      "Say what is wrong with the robot, without a rule: looks for some seconds, changes "
      "nothing, and exits with 0 if it finds nothing");
  add_seconds(*command, "--for", options->seconds, "How long to look", 0.1, 600);
  command->add_flag("--json", options->json, "For programs");
  command->callback([options, &exit_code] { exit_code = examine_robot(*options); });
}

}  // namespace culprit::cli
