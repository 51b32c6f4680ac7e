// A live robot as one Robot: its nodes over DDS, its processes through the operating system.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "inbox/inbox.h"
#include "knowledge/known_robot.h"
#include "link/link.h"
#include "live/running_elsewhere.h"
#include "owners/component_containers.h"
#include "owners/composed_nodes.h"
#include "owners/container_clients.h"
#include "owners/service_units.h"
#include "owners/supervisor.h"
#include "robot/robot.h"

namespace culprit::live {

class LiveRobot : public Robot {
 public:
  struct Options {
    link::Link::Options link;
    owners::Supervisor::Options supervisor;
  };

  ~LiveRobot() override;

  // `rules` must outlive the robot. Errors: the DDS domain cannot be joined; the system gives no thread.
  static Expected<std::unique_ptr<LiveRobot>> open(const RuleSet& rules, Options options);

  Time now() const override { return live_now(); }
  // At most the last moment at which culprit has proven to receive: no silence is measured to a
  // moment at which culprit may have been deaf.
  Time observed_until() const override { return std::min(live_now(), shown_until_); }
  void observe(Time until, std::vector<Observation>& observations) override;
  void execute(const Command& command) override;

  // Starts a component: by its LAUNCH, or through the systemd that runs its UNIT, or the container that loads it; the container has `patience` to do so.
  void start(CommandId command, ComponentId component,
             Duration patience = owners::ComposedNodes::kComingUp);

  // The component ran in this process at `known`, in an earlier run of culprit.
  void adopt_again(ComponentId component, int pid, Time known);

  // On which computers components ran last, in an earlier run of culprit. The last part of a component counts.
  void remember_hosts(const KnownRobot& known);

  // Ends the process that culprit started if another launcher runs the component, too: two nodes of one name are worse than either. Both must be proven, and no
  // other component may end with it that has no other process. `may`: whether anything may be done to the component now.
  void withdraw_doubles(const std::function<bool(ComponentId)>& may);

  void interrupt() override { inbox_.interrupt(); }

  // Time since which it is not sure that culprit receives the robot's messages, or that no other
  // culprit manages it; empty: it is sure.
  std::optional<Time> deaf_since() const { return deaf_since_; }

  // Something about culprit itself that a person should know. From any thread.
  void report(std::string trouble);

  // Takes the priors that the fleet learned. Callable from any thread.
  void tell(PriorsTold priors);

  link::Link& link() { return *link_; }
  owners::Supervisor& supervisor() { return *supervisor_; }

 private:
  static Expected<std::unique_ptr<LiveRobot>> join(const RuleSet& rules, Options options);
  explicit LiveRobot(const RuleSet& rules);

  void listen(Time until, std::vector<Observation>& observations);
  void prove_hearing(std::vector<Observation>& observations);
  void witness(std::size_t before, std::vector<Observation>& observations);
  void tell_what_ends_together(std::size_t before, std::vector<Observation>& observations);
  void stop_process(const Command& command);
  void start_process(CommandId command, ComponentId component);
  void end_process(CommandId command, ComponentId component, int pid, owners::Ending ending,
                   owners::Hangs hangs);

  const RuleSet& rules_;
  Inbox inbox_;
  ComponentBinding binding_;
  owners::ComponentContainers containers_;
  RunningElsewhere elsewhere_;
  owners::AllUnits units_;  // and containers of engines
  std::unique_ptr<owners::Supervisor> supervisor_;
  std::unique_ptr<link::Link> link_;
  std::unique_ptr<owners::ContainerClients> container_clients_;
  std::unique_ptr<owners::ComposedNodes> composed_;
  std::map<ComponentId, std::vector<ComponentId>> ends_with_;  // as it was told
  Time shown_until_ = kNever;
  bool judges_ = true;  // the manager was told that what it hears is all that there is
  std::optional<Time> deaf_since_;
};

}  // namespace culprit::live
