// The model of the navigation: bt_navigator with its recoveries, the controller, and the mission, which gives the goals.
//
// Times are those of bt_navigator.cpp, controller_server.cpp and mission_node.cpp. Instead of a path in a map, a goal has a length
// that the rover drives; it turns towards it first.
#pragma once

#include <vector>

#include "base/time.h"
#include "robot/observation.h"
#include "simulation/random.h"

namespace culprit::rover::model {

class Trip {
 public:
  // The inputs of the navigation in one tick.
  struct Works {
    bool navigator = false;  // its server is active and answers; so the next three
    bool planner = false;
    bool controller = false;
    bool behavior = false;
    bool in_map = false;      // the transforms from the map to the base are new enough
    bool sees = false;        // the controller has a scan that is new enough
    bool is_lost = false;     // it drives, but not towards the goal
    bool oscillates = false;  // the controller
    double max_speed = 0;     // of the controller, metres a second
    double moved = 0;         // by odometry since the last tick, metres
  };
  struct Command {
    double speed = 0;  // metres a second
    double turn = 0;   // radians a second
  };

  explicit Trip(simulation::Random random) : random_(random) {}

  // Gives what /cmd_vel_nav says in this tick; nothing: it is silent.
  std::optional<Command> step(Time now, const Works& works);
  // The navigator's process is a new one.
  void forget();

  int reached() const { return reached_; }
  int failed() const { return failed_; }
  // All goals that the navigator remembers; whether they changed since the last call.
  const std::vector<GoalsSeen::Goal>& goals() const { return goals_; }
  bool take_news() { return std::exchange(has_news_, false); }

 private:
  enum class Doing : std::uint8_t { kNothing, kPlanning, kFollowing, kRecovering };

  void send_goal(Time now, const Works& works);
  void navigate(Time now, const Works& works);
  void recover(Time now);
  void finish(GoalStatus status);
  std::optional<Command> follow(Time now, const Works& works);
  Command drive(Time now, const Works& works);

  simulation::Random random_;
  Doing doing_ = Doing::kNothing;
  Time due_{};
  Time heard_ = kLongAgo;      // the mission: the last feedback
  Time asked_ = kLongAgo;      // the mission looks each 500 ms
  Time began_{};               // this goal
  Time well_{};                // the controller: its inputs were there
  Time progress_{};            // the controller: the rover moved
  double since_progress_ = 0;  // metres
  double left_ = 0;            // metres to the goal
  bool is_following_ = false;  // the controller
  bool is_backing_ = false;    // the behavior server
  int recoveries_ = 0;
  int reached_ = 0;
  int failed_ = 0;
  std::vector<GoalsSeen::Goal> goals_{};
  std::uint64_t last_goal_ = 0;
  bool has_news_ = false;
};

}  // namespace culprit::rover::model
