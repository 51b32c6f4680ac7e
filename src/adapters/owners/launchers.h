// The programs that started the components which culprit did not start: a launch file, a shell. For each component: which
// one it is, whether it runs, and, once, that it has exited (LauncherSeen).
#pragma once

#include <map>
#include <optional>
#include <poll.h>
#include <vector>

#include "base/time.h"
#include "inbox/inbox.h"
#include "language/rule_set.h"
#include "owners/component_programs.h"
#include "owners/file_descriptor.h"

namespace culprit::owners {

// Not thread-safe: the supervisor's mutex guards it.
class Launchers {
 public:
  // Notes the launchers in the folder of the logs (launch_note.h). `programs` and `inbox` must outlive it.
  Launchers(const ComponentPrograms& programs, Inbox& inbox) : programs_(programs), inbox_(inbox) {}

  // The component's process `pid` runs. `is_others`: culprit did not start it.
  void note_process(ComponentId component, int pid, bool is_others);
  // The component's process, which culprit did not start, has ended.
  void note_end(ComponentId component, int pid);

  // Reports the component's launcher, if it runs.
  void report(ComponentId component) const;
  // Reports those that have ended since.
  void report_ended();

  // The launcher of the component, if it runs; 0: there is none.
  int running(ComponentId component) const;
  // Whether it, and not culprit, starts the component again. Also if it is unknown: two processes of one name would be
  // worse than none.
  bool restarts(ComponentId component) const;
  // Whether its process `pid`, which culprit did not start, ran as a job in the foreground of a terminal when it was looked
  // last. If such a job ends in an orderly way, a person ended it: the shell goes on.
  bool ran_in_foreground(ComponentId component, int pid) const;
  // Whether the component's process `pid` is stopped together with its launcher, or with all of its job in a terminal
  // (is_stopped_job()): a person did that.
  bool is_stopped_with(ComponentId component, int pid) const;

  // Looks which children they have.
  void look_at_children();
  // Adds what becomes readable when one of them ends.
  void add_to(std::vector<pollfd>& watched) const;

 private:
  struct Launcher {
    int pid = 0;  // 0: it has ended, or it was a supervisor, since that had ended
    std::optional<Time> began{};
    std::vector<int> children{};    // when it was looked last
    bool ran_others = false;        // when the component's process had ended
    FileDescriptor held{};          // until its end, which is reported
    int process = 0;                // of the component, that it started
    bool is_in_foreground = false;  // that process, when it was looked last
  };

  void hold(ComponentId component, int launcher, int process);
  static bool goes_on(const Launcher& launcher);
  static void look_at_children_of(Launcher& launcher);

  const ComponentPrograms& programs_;
  Inbox& inbox_;
  std::map<ComponentId, Launcher> launchers_;
};

}  // namespace culprit::owners
