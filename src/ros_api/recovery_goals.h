// Clients that wait for the recovery of a component, or of the whole robot: the goals of the action
// WaitForRecovery (ros/culprit_msgs/action), without the middleware.
//
//     RecoveryGoals goals;
//     goals.begin({id, "camera", 10s}, now, wall);
//     goals.look(status);       // each culprit_msgs/msg/Status that is told
//     goals.expire(now);        // when goals.due() has come
//     for (const auto& end : goals.take_ended()) answer(end.id, end.state, end.result);
//
// A component has recovered when its node is there, no failed rule involves it, and nothing changes
// it. Its process is neither stopped, hung nor exited. The robot has recovered when that holds for
// all of its components and nothing else is wrong either. An unknown state is no recovery: an
// unreachable robot, and one that has not been checked yet.
//
// One thread.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "base/time.h"
#include "json/json.h"

namespace culprit::ros_api {

using WallTime = std::chrono::system_clock::time_point;

class RecoveryGoals {
 public:
  static constexpr std::size_t kMostOpen = 32;   // of more the oldest is aborted
  static constexpr std::size_t kMostEnded = 64;  // whose results are kept

  using Id = std::array<std::uint8_t, 16>;  // unique_identifier_msgs/msg/UUID

  // As action_msgs/msg/GoalStatus numbers them. Nothing is between: a waiting goal neither starts
  // nor stops.
  enum class State : std::int8_t {
    kUnknown = 0,
    kExecuting = 2,
    kSucceeded = 4,
    kCanceled = 5,
    kAborted = 6
  };

  struct Request {
    Id id{};
    std::string component;  // empty: the whole robot
    Duration timeout{};     // 0: as long as it takes
  };
  struct Goal {
    Request request;
    WallTime accepted{};
    Time ends = kNever;
    State state = State::kExecuting;
    Json feedback;  // a WaitForRecovery_Feedback, as published last; null: none was
    Json result;    // a WaitForRecovery_Result, once it has ended
  };

  // False: its id is taken. look_again() gives its first feedback, if there is any.
  bool begin(const Request& request, Time now, WallTime wall);

  // Messages of type Status; the newest is kept for goals to come.
  void look(Json status);
  void look_again();
  void expire(Time now);
  // When expire() has something to do; kNever: nothing.
  Time due() const;

  // As action_msgs/srv/CancelGoal asks for it: the goal with that id, those accepted until `until`; all where
  // neither is given. Gives those that were canceled.
  std::vector<Id> cancel(const Id& id, WallTime until);
  // Whether one was accepted and has not been forgotten, and how it is.
  const Goal* find(const Id& id) const;

  // The news that were not taken yet: goals that have ended, and others whose feedback has changed.
  std::vector<Id> take_ended();
  std::vector<Id> take_news();

  // Oldest first.
  std::vector<const Goal*> all() const;

 private:
  void forget_some();
  void make_room();
  void consider(Goal& goal);
  void end(Goal& goal, State state, std::string message);

  Json status_;  // null: none was published
  std::map<Id, Goal> goals_;
  std::deque<Id> order_;  // in which they came
  std::vector<Id> ended_, news_;
};

}  // namespace culprit::ros_api
