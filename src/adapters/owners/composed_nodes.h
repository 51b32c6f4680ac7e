// Components that a component container loads (IN /container PLUGIN package::Class).
//
// culprit asks the container to unload a component and to load it again, and believes that it did
// so once it lists its nodes so. Before a load, culprit checks that no node of that name is loaded,
// so that none is loaded twice.
//
// If the container does not unload it, or does not answer, the container itself is replaced: its
// owner ends and starts it, and everything that lived in it is loaded again, in order, producers
// first. That is done only if all of it can come back: the container is a component that can start
// again, and the rules describe how to load each node that it lists. If the container has exited,
// for whatever reason, culprit loads its former components when it starts the container. A
// component that somebody unloaded on purpose before is not loaded.
//
// If somebody else unloads a component, its node leaves the graph, and its container goes on and does
// not list it: that is reported (Unloaded). A component cannot crash without its container.
//
// A stop names the process that it is meant for. Once that process has exited, the stop is done,
// and nothing is unloaded from the container's successor.
//
// If a component's class or parameter file is missing, it cannot be loaded: the missing one is
// reported (StartBarred). It is checked every Supervisor::kMissingPeriod until it exists.
//
// Proof before harm. A container is asked only if its process is known, by the same proofs as any
// other process. Its answers count only if they come from that process. While two nodes have its
// name, neither is asked.
//
// Each container has a thread of its own here, which makes one request after the other. If this
// object is destroyed while a container comes up, the next one loads the missing components with
// the first component that it starts there.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "inbox/inbox.h"
#include "language/rule_set.h"
#include "owners/container_services.h"
#include "owners/supervisor.h"

namespace culprit::owners {

// All members may be called from any thread. Replies go to the inbox.
class ComposedNodes {
 public:
  // Until a container has to answer what it has at hand; until a node must have left the graph
  // after the container reported it unloaded.
  static constexpr Duration kAnswer = std::chrono::seconds(2);
  static constexpr Duration kHungAnswer = std::chrono::milliseconds(500);
  static constexpr Duration kUnload = std::chrono::seconds(3);
  // A container that did not answer an unload may still do it for so long.
  static constexpr Duration kLateUnload = std::chrono::seconds(30);
  // Until a container that was started must be in the graph.
  static constexpr Duration kComingUp = std::chrono::seconds(30);
  // How long a node may take to load in a container that was started here.
  static constexpr Duration kLoad = std::chrono::seconds(30);

  // The owner of a container's own process: starts and ends it. The reply to a command has to come
  // to answered(). May be called from any thread.
  struct ContainerOwner {
    std::function<void(CommandId, ComponentId)> start;
    std::function<void(CommandId, ComponentId, int pid, Ending, Hangs)> stop;
  };

  // `order`: all components, in the order in which they come up. The references must outlive this.
  ComposedNodes(const RuleSet& rules, const std::vector<ComponentId>& order,
                ContainerServices& services, ContainerOwner owner, Inbox& inbox);
  ~ComposedNodes();

  // Whether start() and stop() are to be asked here: it lives in a container, or is one.
  bool is_responsible_for(ComponentId component) const;

  void start(CommandId command, ComponentId component, Duration patience);
  // `pid`: the process that is meant, the container's; 0: whichever it is.
  void stop(CommandId command, ComponentId component, int pid, Ending ending, Hangs hangs);

  void observe(const Observation& observation);
  // The component lived in this process when an earlier run of culprit saw it.
  void remember(ComponentId component, int pid);
  // Whether the reply is for a request of this object to a container's owner.
  bool answered(const Reply& reply);

 private:
  void end();
  struct Errand {
    enum class Kind : std::uint8_t { kStart, kStop };
    CommandId command;
    ComponentId component;
    Kind kind = Kind::kStart;
    Duration patience{};
    int pid = 0;
    Ending ending = Ending::kForGood;
    Hangs hangs = Hangs::kNo;
  };
  struct Container {
    std::string node;
    std::optional<ComponentId> component;  // that it is itself
    std::vector<ComponentId> parts;        // that it loads, in order
    std::deque<Errand> errands{};
    bool has_news = false;  // somebody came to it since it was asked what it has
    // Used by its thread only.
    std::map<ComponentId, int> unanswered{};        // loads, and the process that was asked
    std::set<ComponentId> barred{};                 // parts whose class or parameters are missing
    std::optional<std::set<std::string>> listed{};  // its last list
    int listed_by = 0;                              // the process that gave that list
    Time coming_up = kLongAgo;                      // until when, since it was started here
    int coming_pid = 0;                             // its process then; 0: not known
    std::thread thread{};
  };
  // Where a part lives, or lived last.
  struct Life {
    int pid = 0;
    std::optional<Time> left{};   // the graph, since
    Time taken_until = kLongAgo;  // if it leaves before that, culprit has it unloaded
  };
  struct Answer {
    Outcome outcome = Outcome::kDone;
    std::string text{};
    int pid = 0;
  };

  void run(Container& container);
  void look(Container& container);
  std::vector<ComponentId> take_unloaded(const Container& container, int pid);
  void note_missing(Container& container, ComponentId part, const std::string& what);
  void look_for_missing(Container& container);
  void put(Errand errand);
  void reply(CommandId command, const Answer& answer);

  // On a container's thread.
  Answer stop_part(Container& container, const Errand& errand);
  Answer stop_container(Container& container, const Errand& errand);
  void start_part(Container& container, const Errand& errand);
  Answer unload(Container& container, const Errand& errand, int pid, bool& is_stuck);
  void note_failed_unload(ComponentId part, Outcome outcome);
  Answer replace(Container& container, int pid, Hangs hangs);
  std::string why_not_replace(const Container& container, int pid) const;
  Answer ensure(Container& container, Duration patience);
  Answer begin(Container& container);
  static bool is_coming(const Container& container);
  void load_all(Container& container, int pid, const Errand& errand);
  Answer load(Container& container, ComponentId part, int pid, Duration patience);
  ContainerAnswer list(Container& container, int pid, Duration patience);
  Answer ask_owner(const std::function<void(CommandId)>& ask, Duration patience);

  struct Process {
    bool is_there = false;  // its node is in the graph, and its process has not ended
    int pid = 0;            // 0: not proven
  };
  Process process_of(const std::string& node) const;
  bool is_lost(const Container& container, ComponentId part, int pid) const;
  template <class Done>
  bool wait(Time until, Done done) const;  // `done` is called with the mutex

  const RuleSet& rules_;
  ContainerServices& services_;
  const ContainerOwner owner_;
  Inbox& inbox_;
  std::map<ComponentId, Container*> container_of_;  // of what lives there, and of what it is

  mutable Mutex mutex_;  // also guards the errands of a container, and whether it has news
  mutable ConditionVariable something_came_;
  std::map<std::string, int> nodes_
      CULPRIT_GUARDED_BY(mutex_);  // of the graph, with their processes; 0: not known
  std::map<std::string, Time> left_
      CULPRIT_GUARDED_BY(mutex_);  // when a container's node left the graph last
  std::map<ComponentId, Life> lives_ CULPRIT_GUARDED_BY(mutex_);
  std::map<CommandId, std::optional<Reply>> asked_ CULPRIT_GUARDED_BY(mutex_);  // owners
  std::uint64_t requests_ CULPRIT_GUARDED_BY(mutex_) = 0;
  bool is_ending_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::vector<std::unique_ptr<Container>> containers_;  // all that there ever are
};

}  // namespace culprit::owners
