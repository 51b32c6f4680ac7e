#include "owners/launchers.h"

#include <algorithm>
#include <chrono>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/process_stat.h"
#include "owners/launch_note.h"
#include "owners/mark.h"
#include "owners/proc.h"
#include "owners/process_end.h"

namespace culprit::owners {

void Launchers::note_process(ComponentId component, int pid, bool is_others) {
  const PlaceHeld place = is_others ? PlaceHeld{} : place_held_by(pid);
  Origin origin = is_others ? origin_of(pid) : Origin{Origin::What::kEnded, 0};
  if (place.goes_on) origin = {Origin::What::kKnown, place.launcher};
  const bool is_known = origin.what == Origin::What::kKnown;
  if (is_others)
    note_launch(programs_.log_folder, programs_.mark(component), is_known ? origin.pid : 0);
  switch (origin.what) {
    case Origin::What::kEnded:
      launchers_[component] = Launcher{};
      return;
    case Origin::What::kUnknown:
      launchers_.erase(component);
      return;
    case Origin::What::kKnown:
      return hold(component, origin.pid, pid);
  }
}

void Launchers::note_end(ComponentId component, int pid) {
  const auto launcher = launchers_.find(component);
  if (launcher == launchers_.end()) return;
  look_at_children_of(launcher->second);
  launcher->second.ran_others =
      std::ranges::any_of(launcher->second.children, [&](int child) { return child != pid; });
}

// Another one of the component may run in place of a process of that launch.
void Launchers::hold(ComponentId component, int launcher, int process) {
  Launcher& held = launchers_[component] = Launcher{launcher, started_at(launcher)};
  held.held = FileDescriptor(static_cast<int>(syscall(SYS_pidfd_open, launcher, 0)));
  held.process = process;
  look_at_children_of(held);
}

void Launchers::look_at_children() {
  for (auto& [component, launcher] : launchers_) look_at_children_of(launcher);
}

// A launcher may end before it is noticed that what it started has, and while its children are read.
void Launchers::look_at_children_of(Launcher& launcher) {
  if (!launcher.held || !goes_on(launcher)) return;
  std::vector<int> children = children_of(launcher.pid);
  if (goes_on(launcher)) launcher.children = std::move(children);
  if (const auto is_job = is_foreground_job(launcher.process, launcher.pid))
    launcher.is_in_foreground = *is_job;
}

bool Launchers::goes_on(const Launcher& launcher) {
  if (launcher.pid == 0) return false;
  const auto stat = process_stat(std::to_string(launcher.pid));
  if (!stat || stat->state == 'Z' || stat->is_exiting) return false;
  // Two readings of one start differ by the clocks' rounding.
  constexpr Duration kSame = std::chrono::milliseconds(100);
  const auto begins = started_at(launcher.pid);
  return begins && launcher.began && std::chrono::abs(*begins - *launcher.began) < kSame;
}

void Launchers::report(ComponentId component) const {
  const auto launcher = launchers_.find(component);
  if (launcher != launchers_.end() && launcher->second.held)
    inbox_.put(LauncherSeen{component, launcher->second.pid, false});
}

void Launchers::report_ended() {
  for (auto& [component, launcher] : launchers_) {
    if (!launcher.held || !is_readable(launcher.held.get())) continue;
    const ProcessEnd end = end_of(launcher.pid, launcher.held.get());
    launcher.held = FileDescriptor();
    inbox_.put(LauncherSeen{component, launcher.pid, true, end.cause == Cause::kFault,
                            launcher.ran_others});
  }
}

int Launchers::running(ComponentId component) const {
  const auto launcher = launchers_.find(component);
  return launcher != launchers_.end() && goes_on(launcher->second) ? launcher->second.pid : 0;
}

bool Launchers::restarts(ComponentId component) const {
  if (!programs_.rules[component].is_respawned) return false;
  const auto launcher = launchers_.find(component);
  return launcher == launchers_.end() || goes_on(launcher->second);
}

bool Launchers::ran_in_foreground(ComponentId component, int pid) const {
  const auto launcher = launchers_.find(component);
  return launcher != launchers_.end() && launcher->second.process == pid &&
         launcher->second.is_in_foreground;
}

bool Launchers::is_stopped_with(ComponentId component, int pid) const {
  const auto launcher = launchers_.find(component);
  if (launcher == launchers_.end() || !launcher->second.held) return false;
  const int its_launcher = launcher->second.pid;
  return state_letter(its_launcher) == 'T' || is_stopped_job(pid, its_launcher);
}

void Launchers::add_to(std::vector<pollfd>& watched) const {
  for (const auto& [component, launcher] : launchers_) {
    if (launcher.held) watched.push_back({launcher.held.get(), POLLIN, 0});
  }
}

}  // namespace culprit::owners
