// Whether those that alone publish what the rules watch, and of which nothing comes, know that it is
// listened to (ListenerKnown).
//
// Discovery data is ordered for each participant (service_client.h): a node that answers a client
// has discovered each reader that was made before it. So each topic has a client of its own, made
// after its reader.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "inbox/inbox.h"
#include "ros2/executor.h"
#include "ros2/graph.h"
#include "ros2/service_client.h"
#include "ros2/timer.h"

namespace culprit::link {

// On the executor's thread, but for seek(), which any thread may call.
class ListeningProof {
 public:
  struct Silent {
    TopicId topic;
    std::string publisher;                        // the only node that publishes it
    std::optional<rtps::GuidPrefix> participant;  // that holds it
  };
  // Gives the topics that are listened to and of which nothing came.
  using FindSilent = std::function<std::vector<Silent>()>;

  // All outlive it.
  ListeningProof(ros2::NodeEntry& self, ros2::Executor& executor, Inbox& inbox, FindSilent find)
      : self_(self), executor_(executor), inbox_(inbox), find_(std::move(find)), tasks_(executor) {}

  // Asks until then.
  void seek(Time until);

 private:
  void look();
  void ask(const Silent& silent, Duration patience);

  ros2::NodeEntry& self_;
  ros2::Executor& executor_;
  Inbox& inbox_;
  const FindSilent find_;
  std::map<TopicId, std::unique_ptr<ros2::ServiceClient>> asked_;
  Time until_ = kLongAgo;
  std::unique_ptr<ros2::Timer> looking_;
  ros2::TaskGroup tasks_;
};

}  // namespace culprit::link
