// The mark that processes of components carry in their environment, so that the next supervisor of
// the same robot recognizes them.
//
// A child process inherits the mark and is not the component. So a second variable holds the PID of
// the component's process, and a third one the PID namespace: in another namespace that PID is
// another process. A fourth one holds the network namespace: in another network the same domain
// and the same name are another robot. A process without it counts in every network.
//
// A process that stands in for one of a launch names that launch: the launcher's PID, and when it
// began.
//
// Any user can start a process with these variables. So a mark counts only in a process of our own user: a component
// whose LAUNCH changes the user (sudo, setpriv) is known for as long as the culprit runs that started it.
#pragma once

#include <string>
#include <vector>

namespace culprit::owners {

inline constexpr const char* kPidVariable = "CULPRIT_PROCESS";

// The variables that are added to the environment of a component's process, beside its PID.
// `component`: "0/sunset/camera".
std::vector<std::string> mark_of(const std::string& component);

// Added to the mark of a process that stands in for one that `launcher` had started. Empty: there is no such launcher.
std::string in_place_of(int launcher);

// The launcher that the process `pid`, or what started it, stands in for.
struct PlaceHeld {
  int launcher = 0;  // 0: it stands in for none
  bool goes_on = false;
};
PlaceHeld place_held_by(int pid);

// A launcher as text, "4711@123456", which no other process ever has. Empty: there is no such process.
std::string to_text(int launcher);
PlaceHeld place_in(const std::string& text);

// Whether it, or what started it, carries the mark, and that was set in our network.
bool carries_mark(int pid, const std::string& component);

// Not one that a marked process started in turn.
bool is_what_was_launched(int pid);

// The variable that the process `pid` and all its descendants have in their environment.
std::string variable_of(int pid);

// The processes of all components whose mark begins with `prefix`: "0/sunset/", "0/".
struct MarkedProcess {
  std::string component;  // "0/sunset/camera"
  int pid = 0;
};
std::vector<MarkedProcess> marked_processes(const std::string& prefix);

// Processes that were launched as the component and have not ended.
std::vector<int> launched_as(const std::string& component);

// Living processes that those of the component had started, also in sessions of their own. `process`: of the one with
// this variable (variable_of) only; empty: of those that have exited.
std::vector<int> left_by(const std::string& component, const std::string& process);
// Whether another process than that with this variable was launched with a mark, and it is part of that one's.
bool is_anothers(int pid, const std::string& process);

}  // namespace culprit::owners
