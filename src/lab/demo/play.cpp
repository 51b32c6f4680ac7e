#include "demo/play.h"

#include <algorithm>
#include <optional>

namespace culprit::lab {
namespace {

using sunset::ProcessFault;

struct ProcessFaultName {
  ProcessFault fault;
  std::string_view name;
};
constexpr ProcessFaultName kProcessFaults[] = {{ProcessFault::kKill, "kill"},
                                               {ProcessFault::kStop, "stop"},
                                               {ProcessFault::kCrashAtStart, "crash"}};

Play play_of(const sunset::Scenario& scenario) {
  return {scenario.name(), {scenario.faults.begin(), scenario.faults.end()}, {}};
}

std::optional<sunset::Member> managed_member(std::string_view name) {
  for (const sunset::Member member : sunset::kManagedMembers) {
    if (sunset::name_of(member) == name) return member;
  }
  return std::nullopt;
}

Expected<Play> process_play(std::string_view name, ProcessFault fault, std::string_view members) {
  Play play{std::string(name), {}, {}};
  while (!members.empty()) {
    const std::size_t end = std::min(members.find('+'), members.size());
    const auto member = managed_member(members.substr(0, end));
    if (!member) {
      return Error{"there is no node '" + std::string(members.substr(0, end)) +
                   "'; known: camera, depth, image_enhancement, sensor_fusion, segmentation"};
    }
    play.process_faults.emplace_back(fault, *member);
    members.remove_prefix(std::min(end + 1, members.size()));
  }
  if (play.process_faults.empty()) return Error{"'" + std::string(name) + "' names no node"};
  return play;
}

}  // namespace

std::vector<std::string> Play::fault_names() const {
  std::vector<std::string> names;
  for (const sunset::Fault* fault : faults) names.emplace_back(fault->name);
  for (const auto& [fault, member] : process_faults) {
    for (const ProcessFaultName& known : kProcessFaults) {
      if (known.fault == fault)
        names.push_back(std::string(known.name) + " " + std::string(sunset::name_of(member)));
    }
  }
  return names;
}

int Play::redeployments_needed() const {
  int needed = 0;
  for (const sunset::Fault* fault : faults) {
    const bool only_redeployment =
        fault->resolved_by.size() == 1 && fault->resolved_by.front().ends_with("_redeploy");
    needed += only_redeployment ? 1 : 0;
  }
  // The first two starts after a crash at start fail as well.
  for (const auto& [fault, member] : process_faults)
    needed += fault == ProcessFault::kCrashAtStart ? 3 : 1;
  return needed;
}

Expected<Play> find_play(std::string_view name) {
  const std::size_t colon = name.find(':');
  if (colon != std::string_view::npos) {
    for (const ProcessFaultName& known : kProcessFaults) {
      if (known.name == name.substr(0, colon))
        return process_play(name, known.fault, name.substr(colon + 1));
    }
    return Error{"'" + std::string(name) +
                 "' is no scenario; write kill:NODE, stop:NODE or crash:NODE"};
  }
  auto scenario = sunset::find_scenario(name);
  if (!scenario) return Error{scenario.error()};
  return play_of(*scenario);
}

std::vector<Play> default_plays() {
  std::vector<Play> plays;
  for (const char* name : {"image_shift+camera_driver_issue", "image_degradation+memory_leakage",
                           "image_shift+gpu_failure"}) {
    plays.push_back(*find_play(name));
  }
  return plays;
}

}  // namespace culprit::lab
