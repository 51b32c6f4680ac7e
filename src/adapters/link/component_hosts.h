// Which computer each component runs on, and which of the other computers are unreachable.
//
// It reports both: LivesOn for a component, HostHeard for a computer.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/mutex.h"
#include "inbox/inbox.h"
#include "link/neighbour_hosts.h"

namespace culprit::link {

// All members may be called from any thread.
class ComponentHosts {
 public:
  ComponentHosts(NeighbourHosts::HeardLast heard_last, Inbox& inbox)
      : hosts_(std::move(heard_last)), inbox_(inbox) {}

  void on_discovery(const ros2::DiscoveryEvent& event);
  // `host`: another computer, as the node's participant announces it; empty: it is on this one.
  void node_joined(const std::string& node, const std::string& host);
  void node_left(const std::string& node);
  // The component runs there; empty: on this computer, or it left in order.
  void lives_on(ComponentId component, const std::string& host);

  // As NeighbourHosts.
  void listens_from(Time now) { hosts_.listens_from(now); }
  Time heard(const std::string& host) const { return hosts_.heard(host); }

  // Finds out which computers are unreachable, and gives the components on them. Only while reception is
  // certain: otherwise nothing new is known of any.
  std::vector<ComponentId> look(Time now);

  // The other computer where it ran last; empty: there is none.
  std::string host_of(ComponentId component) const;
  // The same computer, if it was unreachable at the last look.
  std::optional<std::string> cut_off(ComponentId component) const;
  // The other computers that nodes of the graph run on, by the nodes' full names.
  std::map<std::string, std::string> nodes_elsewhere() const;

 private:
  NeighbourHosts hosts_;
  Inbox& inbox_;

  mutable Mutex mutex_;
  std::map<std::string, std::string> nodes_elsewhere_ CULPRIT_GUARDED_BY(mutex_);  // by node
  std::map<ComponentId, std::string> elsewhere_
      CULPRIT_GUARDED_BY(mutex_);  // the other computer where it ran last, unless it left in order
  std::set<std::string> silent_hosts_ CULPRIT_GUARDED_BY(mutex_);  // that were reported
};

}  // namespace culprit::link
