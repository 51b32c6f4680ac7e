#include "owners/mark.h"

#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <unistd.h>

#include "base/component_mark.h"
#include "owners/proc.h"

namespace culprit::owners {
namespace {

constexpr const char* kNamespaceVariable = "CULPRIT_PROCESS_COUNTS_IN=";
constexpr const char* kNetworkVariable = "CULPRIT_NETWORK=";

constexpr const char* kPlaceVariable = "CULPRIT_IN_PLACE_OF=";

std::string mark(const std::string& component) {
  return std::string(kComponentVariable) + "=" + component;
}

bool is_of_our_network(int pid) {
  const std::string network = value_of_variable(pid, kNetworkVariable);
  return network.empty() || network == network_namespace_of(getpid());
}

}  // namespace

std::vector<std::string> mark_of(const std::string& component) {
  return {mark(component), kNamespaceVariable + pid_namespace_of(getpid()),
          kNetworkVariable + network_namespace_of(getpid())};
}

std::string to_text(int launcher) {
  const auto began = start_ticks_of(launcher);
  return began ? std::to_string(launcher) + "@" + std::to_string(*began) : "";
}

std::string in_place_of(int launcher) {
  const std::string text = to_text(launcher);
  return text.empty() ? "" : kPlaceVariable + text;
}

PlaceHeld place_in(const std::string& text) {
  std::istringstream held(text);
  PlaceHeld place;
  char at = 0;
  std::int64_t began = 0;
  if (!(held >> place.launcher >> at >> began) || at != '@' || place.launcher <= 0) return {};
  const bool has_ended = state_letter(place.launcher).value_or('Z') == 'Z';
  place.goes_on = !has_ended && start_ticks_of(place.launcher) == began;
  return place;
}

PlaceHeld place_held_by(int pid) { return place_in(value_of_variable(pid, kPlaceVariable)); }

bool carries_mark(int pid, const std::string& component) {
  return has_variable(pid, mark(component)) && is_of_our_network(pid);
}

bool is_what_was_launched(int pid) {
  return has_variable(pid, variable_of(pid)) &&
         has_variable(pid, kNamespaceVariable + pid_namespace_of(pid));
}

std::string variable_of(int pid) {
  return kPidVariable + ("=" + std::to_string(own_number_of(pid)));
}

std::vector<MarkedProcess> marked_processes(const std::string& prefix) {
  std::vector<MarkedProcess> all;
  for (const int pid : all_processes()) {
    std::string component = value_of_variable(pid, mark(""));
    const bool has_ended = state_letter(pid).value_or('X') == 'Z';
    if (!component.starts_with(prefix) || has_ended || pid == getpid() ||
        !is_what_was_launched(pid) || !is_of_our_network(pid))
      continue;
    all.push_back({std::move(component), pid});
  }
  return all;
}

std::vector<int> launched_as(const std::string& component) {
  std::vector<int> pids = processes_with(mark(component));
  std::erase_if(pids, [](int pid) {
    const bool has_ended = state_letter(pid).value_or('X') == 'Z';
    return has_ended || pid == getpid() || !is_what_was_launched(pid) || !is_of_our_network(pid);
  });
  return pids;
}

std::vector<int> left_by(const std::string& component, const std::string& process) {
  const std::string counts_in = kNamespaceVariable + pid_namespace_of(getpid());
  std::vector<int> pids = processes_with(mark(component));
  std::erase_if(pids, [&](int pid) {
    if (pid == getpid() || state_letter(pid).value_or('X') == 'Z' || is_what_was_launched(pid) ||
        !has_variable(pid, counts_in) || !is_of_our_network(pid))
      return true;
    if (!process.empty()) return !has_variable(pid, process);
    const int launched = std::atoi(value_of_variable(pid, std::string(kPidVariable) + "=").c_str());
    return launched <= 0 || is_what_was_launched(launched);
  });
  return pids;
}

bool is_anothers(int pid, const std::string& process) {
  const std::string number = value_of_variable(pid, std::string(kPidVariable) + "=");
  return !number.empty() && kPidVariable + ("=" + number) != process;
}

}  // namespace culprit::owners
