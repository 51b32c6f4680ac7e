#include "drill/exported_tests.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text_file.h"

namespace culprit::drill {
namespace {

constexpr double kInjected = 2;  // seconds after the start of a test
constexpr double kReserve = 1;   // seconds more than on the robot, where other things delay more

// Empty: a test has no such fault.
std::string incident(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::kKill:
      return "KILLED";
    case FaultKind::kHang:
      return "STOPPED";
    case FaultKind::kDeactivate:
      return "STATE inactive";
    case FaultKind::kSlow:
    case FaultKind::kRestart:
    case FaultKind::kSetParameter:
    case FaultKind::kLoss:
      return "";
  }
  return "";
}

// Whether a consumer fell silent when its producer was broken: then it needs that one, and does not just listen.
bool needs(const std::string& consumer, const std::string& producer,
           const std::vector<Trial>& trials) {
  return std::ranges::any_of(trials, [&](const Trial& trial) {
    const bool is_alone = trial.faults.size() == 1 && trial.faults[0].component == producer;
    return is_alone && trial.silent.contains(consumer);
  });
}

std::string robot_lines(const HealthyRobot& robot, const std::vector<Trial>& trials) {
  std::string out;
  for (const auto& [name, lifecycle] : robot.lifecycles) {
    std::string line;
    if (lifecycle == "inactive" || lifecycle == "unconfigured") line += "  STATE " + lifecycle;
    if (lifecycle.empty()) line += "  STATE unmanaged";
    std::string needed, subscribed, published;
    for (const auto& [topic, seen] : robot.topics) {
      if (seen.publisher == name) published += " " + topic;
      if (!seen.subscribers.contains(name) || seen.publisher.empty()) continue;
      if (needs(name, seen.publisher, trials)) {
        if (needed.find(" " + seen.publisher) == std::string::npos) needed += " " + seen.publisher;
      } else {
        subscribed += " " + topic;
      }
    }
    if (!needed.empty()) line += "  NEEDS" + needed;
    if (!subscribed.empty()) line += "  SUBSCRIBES" + subscribed;
    if (!published.empty()) line += "  PUBLISHES" + published;
    if (!line.empty()) out += "COMPONENT " + name + line + "\n";
  }
  for (const auto& [topic, seen] : robot.topics)
    if (seen.rate > 0) out += fmt::format("TOPIC {}  0s: {:g}Hz\n", topic, seen.rate);
  return out;
}

}  // namespace

std::string in_quotes(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string test_of(const std::vector<const Trial*>& trials, const std::string& rules,
                    const std::string& date, const HealthyRobot& robot,
                    const std::vector<Trial>& all) {
  const std::vector<Fault>& faults = trials.front()->faults;
  std::string injected;
  std::set<std::string> broken;
  for (const Fault& fault : faults) {
    const std::string what = incident(fault);
    if (what.empty()) return "";
    injected += fmt::format("  AT {:g}s {} {}\n", kInjected, fault.component, what);
    broken.insert(fault.component);
  }
  // Expected is only the result that each trial had.
  std::vector<Finding> findings;
  for (const Trial* trial : trials) findings.push_back(finding_of(*trial));
  const auto in_all = [&](const auto& holds) { return std::ranges::all_of(findings, holds); };
  double noticed = 0;
  double well = 0;
  for (const Finding& each : findings) {
    noticed = std::max(noticed, each.noticed_after.value_or(0));
    well = std::max(well, each.well_after.value_or(0));
  }
  std::string expected;
  const std::string& rule = findings.front().rule;
  if (in_all([&](const Finding& each) { return each.noticed_after && each.rule == rule; })) {
    expected += fmt::format("  EXPECT {} DETECTED BY {:g}s\n", rule,
                            std::ceil(kInjected + noticed + kReserve));
    if (in_all([](const Finding& each) { return each.well_after.has_value(); }))
      expected += fmt::format("  EXPECT {} RESOLVED BY {:g}s\n", rule,
                              std::ceil(kInjected + 2 * well + kReserve));
  }
  for (const std::string& component : broken) {
    if (in_all([&](const Finding& each) { return each.blamed.contains(component); }))
      expected += "  EXPECT " + component + " BLAMED\n";
  }
  for (const auto& [component, lifecycle] : robot.lifecycles) {
    if (!broken.contains(component) &&
        in_all([&, &name = component](const Finding& each) { return !each.blamed.contains(name); }))
      expected += "  EXPECT NO STRATEGY OF " + component + "\n";
  }
  return fmt::format(
      "# {} on the robot: drill {}, {} times\n\nRULES {}\n\n{}\nTEST \"{}\"\n{}  RUN "
      "{:g}s\n{}",
      to_string(faults), date, trials.size(), in_quotes(rules), robot_lines(robot, all),
      to_string(faults), injected, std::ceil(kInjected + 2 * well + 10), expected);
}

Expected<std::size_t> export_tests(const std::filesystem::path& folder, const std::string& rules,
                                   const std::string& date, const std::vector<Trial>& trials,
                                   const HealthyRobot& robot) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error{"cannot make '" + folder.string() + "': " + error.message()};
  std::map<std::string, std::vector<const Trial*>> by_fault;
  for (const Trial& trial : trials)
    if (trial.trouble.empty()) by_fault[to_string(trial.faults)].push_back(&trial);
  std::size_t written = 0;
  for (const auto& [fault, group] : by_fault) {
    const std::string text = test_of(group, rules, date, robot, trials);
    if (text.empty()) continue;
    std::string name = fault;
    std::ranges::replace_if(
        name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '_'; }, '-');
    if (auto done = write_text((folder / (name + ".test")).string(), text); !done)
      return Error{done.error()};
    ++written;
  }
  return written;
}

}  // namespace culprit::drill
