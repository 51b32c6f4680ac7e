// Nodes that are announced to have left, where that may be untrue: any program on the network can
// announce it in their names. Their nodes are asked.
//
// Two kinds of announcement are doubted:
// - A participant whose process is not proven leaves. If it is there after all, its middleware announces it
//   again: Fast DDS after 3 s, Cyclone DDS after 8 s. Then its node is asked, and what the same
//   participant answers counts.
// - A message says that a participant, which stays, holds the node no more (NodeSaidToLeave). The
//   node is asked at once, twice. One that answers may be leaving all the same, so it is asked
//   again while that is announced.
//
// A component's node that was ordered to leave is not asked (expect()).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "base/mutex.h"
#include "base/time.h"
#include "inbox/inbox.h"
#include "ros2/context.h"
#include "ros2/executor.h"
#include "ros2/graph.h"

namespace culprit::link {

// On the executor's thread, but for expect(), which any thread may call.
class LeavingAnnouncements {
 public:
  // Asks whether the node is there, and gives the participant that answered, if any does. `then` may be called on
  // any thread, and before this returns.
  using Then = std::function<void(std::optional<rtps::GuidPrefix> answered)>;
  using Ask = std::function<void(const std::string& node, Then then)>;
  // The node has left.
  using Left = std::function<void(const std::string& node, bool was_lost)>;

  // `executor` and `inbox` outlive it.
  LeavingAnnouncements(ros2::Executor& executor, Inbox& inbox, Ask ask, Left left);
  // Before the first node joins. It outlives the last call.
  void watch(ros2::Context& context) { context_ = &context; }

  // A component's node joined the graph.
  void joined(const ros2::GraphNode& node);
  // Any node: it is there again.
  void is_back(const std::string& node);
  // A node left the graph.
  void left(const std::string& node, bool was_lost);
  // NodeSaidToLeave.
  void said_to_leave(const std::string& node);

  // The component's node was ordered to leave: until then it is not asked.
  void expect(ComponentId component, Time until);
  // Whether an announcement that the component's node leaves is doubted now.
  bool is_doubted(ComponentId component, const std::string& node) const;

 private:
  // Nodes whose process is not known, and the participant that has each.
  struct Unproven {
    ros2::Vendor vendor = ros2::Vendor::kOther;
    rtps::GuidPrefix participant{};
  };
  struct Leaving {
    Unproven node;
    bool was_lost = false;
    std::uint64_t doubt = 0;  // which of all
    bool is_told = false;     // that it answers all the same
  };

  void doubt(const std::string& node, Leaving leaving);
  void ask_leaving(const std::string& node, std::uint64_t doubt);
  void believe(const std::string& node, std::optional<rtps::GuidPrefix> answered,
               std::uint64_t doubt);
  void ask_again(const std::string& node);
  void ask_whether_left(const std::string& node, int questions);
  void on_whether_left(const std::string& node, int questions, bool answers);

  Inbox& inbox_;
  const Ask ask_;
  const Left left_;
  ros2::Context* context_ = nullptr;

  std::map<std::string, Unproven> unproven_;  // by node
  std::map<std::string, Leaving> leaving_;    // such nodes that are announced to have left
  std::uint64_t doubts_ = 0;
  std::set<std::string> asked_whether_left_;     // nodes that were announced to leave
  std::set<std::string> told_of_false_leaving_;  // those of them that answered once

  mutable Mutex mutex_;
  std::map<ComponentId, Time> expected_ CULPRIT_GUARDED_BY(mutex_);  // until then
  ros2::TaskGroup tasks_;
};

}  // namespace culprit::link
