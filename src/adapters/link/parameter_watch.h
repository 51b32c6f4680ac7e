// Reads /parameter_events for the parameters that the rules name.
//
// An event counts only from a writer of the node itself. One from another writer, or from one that is
// not known as the node's yet, is a reason to ask the node. So is one that has no room among those that wait: somebody
// else may have sent all the others.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "base/expected.h"
#include "base/mutex.h"
#include "inbox/inbox.h"
#include "language/rule_set.h"
#include "link/other_nodes.h"
#include "link/waiting_lookups.h"
#include "robot/component_binding.h"
#include "ros2/context.h"
#include "ros2/messages.h"
#include "ros2/subscription.h"

namespace culprit::link {

class ParameterWatch {
 public:
  // Reads the component's parameters from its node. On the executor's thread.
  using Ask = std::function<void(ComponentId)>;

  // All outlive it.
  ParameterWatch(const ros2::Context& context, ros2::Executor& executor, const RuleSet& rules,
                 Inbox& inbox, const ComponentBinding& binding, const OtherNodes& others, Ask ask)
      : context_(context),
        rules_(rules),
        inbox_(inbox),
        binding_(binding),
        others_(others),
        ask_(std::move(ask)),
        tasks_(executor) {}

  // Before the executor runs. An error when the middleware, or the domain's permissions, refuse.
  Expected<void> start(ros2::NodeEntry& self);

 private:
  void on_sample(const ros2::Sample& sample);
  void on_event(const ros2::msg::ParameterEvent& event, const rtps::Guid& writer);
  void on_lost_event(const rtps::Guid& writer);
  void doubt(ComponentId component, const std::string& node, const std::string& by);
  void ask(ComponentId component);

  const ros2::Context& context_;
  const RuleSet& rules_;
  Inbox& inbox_;
  const ComponentBinding& binding_;
  const OtherNodes& others_;
  const Ask ask_;
  Mutex mutex_;
  WaitingLookups waiting_ CULPRIT_GUARDED_BY(mutex_){ros2::msg::ParameterEvent::kLargest};
  struct Asked {
    Time last = kLongAgo;
    bool is_due = false;  // once more, at the end of the pause
  };
  std::map<ComponentId, Asked> asked_;  // because of an event that does not count
  std::set<std::pair<std::string, std::string>> told_of_;  // nodes, and the sources in their names
  ros2::TaskGroup tasks_;
  std::unique_ptr<ros2::RawSubscription> subscription_;
};

}  // namespace culprit::link
