#include "owners/mark.h"

#include <unistd.h>

#include "owners/proc.h"

namespace culprit::owners {
namespace {

constexpr const char* kComponentVariable = "CULPRIT_COMPONENT=";
constexpr const char* kNamespaceVariable = "CULPRIT_PROCESS_COUNTS_IN=";

std::string mark(const std::string& component) { return kComponentVariable + component; }

}  // namespace

std::vector<std::string> mark_of(const std::string& component) {
  return {mark(component), kNamespaceVariable + pid_namespace_of(getpid())};
}

bool carries_mark(int pid, const std::string& component) {
  return has_variable(pid, mark(component));
}

bool is_what_was_launched(int pid) {
  return has_variable(pid, variable_of(pid)) &&
         has_variable(pid, kNamespaceVariable + pid_namespace_of(pid));
}

std::string variable_of(int pid) {
  return kPidVariable + ("=" + std::to_string(own_number_of(pid)));
}

std::vector<int> launched_as(const std::string& component) {
  std::vector<int> pids = processes_with(mark(component));
  std::erase_if(pids, [](int pid) {
    const bool has_ended = state_letter(pid).value_or('X') == 'Z';
    return has_ended || pid == getpid() || !is_what_was_launched(pid);
  });
  return pids;
}

}  // namespace culprit::owners
