// Listens to topics of a robot as briefly and as lightly as findings need it.
//
// Readers are best effort, except for latched topics, and copy only the header of a message. A topic is only subscribed to if a node of the robot does so
// already: some nodes publish only with a subscriber, and a topic without one does not matter. A topic with much data is released after some messages.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "doctor/picture.h"
#include "ros2/subscription.h"

namespace culprit::doctor {

struct WantedTopic {
  std::string name;
  std::string type;
  rtps::Keys keys = rtps::Keys::kNone;
  bool is_latched = false;    // all its publishers latch: what was published before is wanted, too
  bool is_stamped = false;    // its messages begin with a header
  bool has_deadline = false;  // a node demands one: its pauses are compared with it
  bool operator==(const WantedTopic&) const = default;
};

// On the executor's thread, except for message callbacks.
class Listening {
 public:
  // More take turns: each reader costs every participant of the robot a little.
  static constexpr std::size_t kMostAtOnce = 60;
  // So much is enough of a topic that brings much data.
  static constexpr std::size_t kEnoughMessages = 20;
  static constexpr std::size_t kMuchData = 2'000'000;  // bytes
  // So long is enough of one while others wait.
  static constexpr Duration kTurn = std::chrono::seconds(5);
  // A shorter turn yields less than the discovery of its readers costs the robot and us.
  static constexpr Duration kWorthIt = std::chrono::seconds(4);

  // `self` outlives it. `simulated_now`: what /clock shows; called on receive threads.
  Listening(ros2::NodeEntry& self, std::function<std::optional<Duration>()> simulated_now);
  ~Listening();

  // Listens to these, as soon as their turn comes, besides those that it listens to.
  void listen_to(const std::vector<WantedTopic>& topics);
  // Ends listening where enough was heard, and begins where others waited. To be called now and then; `left`: of
  // the look.
  void take_turns(Time now, Duration left);

  std::map<std::string, Flow> flows(Time now) const;
  // How many have not had their turn.
  std::size_t waiting() const { return waiting_.size(); }

  // Forgets what was heard, and listens on; those that waited go first.
  void begin_anew(Time now);

 private:
  class Ear;
  ros2::NodeEntry& self_;
  const std::function<std::optional<Duration>()> simulated_now_;
  std::map<std::string, std::unique_ptr<Ear>> ears_;  // also those that were let go
  std::set<std::string> known_;                       // of this look
  std::deque<WantedTopic> waiting_;
};

}  // namespace culprit::doctor
