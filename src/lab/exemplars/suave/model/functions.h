// The nodes that do something: search, follow, recover, recharge.
//
// They configure themselves at their start, and do nothing until they are activated.
#pragma once

#include <deque>

#include "exemplars/suave/model/helm.h"
#include "exemplars/suave/model/members.h"
#include "exemplars/suave/model/mission_plan.h"
#include "exemplars/suave/model/spiral.h"

namespace culprit::suave::model {

// All that is referred to must outlive the node, here and below.
class SearchNode : public simulation::Node {
 public:
  SearchNode(simulation::World& world, const Generation& generation, Helm& helm);

 private:
  void on_start() override;
  void on_activate() override;
  void tick();

  const Generation& generation_;
  Helm& helm_;
  Spiral spiral_;
};

class FollowNode : public simulation::Node {
 public:
  FollowNode(simulation::World& world, Topics& topics, const Generation& generation, Helm& helm);

 private:
  void on_start() override;
  void on_activate() override;
  void poll();
  void go_on();
  bool is_there() const;

  const Generation& generation_;
  Helm& helm_;
  simulation::Publisher<Data> distance_topic_;
  simulation::Publisher<Data> inspected_topic_;
  bool has_path_ = false;
  std::deque<Position> path_;  // that is still to come
  std::optional<Position> goal_;
  std::optional<Position> last_;  // reached
  double distance_ = 0;
  int polls_ = 0;  // since the goal was published
};

// Recovers all thrusters, one after the other.
class MotionNode : public simulation::Node {
 public:
  MotionNode(simulation::World& world, const Generation& generation, Helm& helm);

 private:
  void on_activate() override;
  void on_deactivate() override;
  void recover(int thruster, int activation);

  const Generation& generation_;
  Helm& helm_;
  int activations_ = 0;
};

// Goes to the charging station.
class RechargeNode : public simulation::Node {
 public:
  RechargeNode(simulation::World& world, const Generation& generation, Helm& helm);

 private:
  void on_start() override;
  void tick();

  const Generation& generation_;
  Helm& helm_;
};

}  // namespace culprit::suave::model
