#include "exemplars/suave/model/functions.h"

#include "exemplars/suave/model/pipeline.h"
#include "exemplars/suave/model/vehicle.h"

namespace culprit::suave::model {
namespace {

using namespace std::chrono_literals;

// A node's start until it is in the graph; what a lifecycle or parameter callback takes.
simulation::NodeTraits function_node() {
  simulation::NodeTraits traits;
  traits.start = {300ms, 400ms};
  traits.starts_as = Lifecycle::kInactive;
  traits.end = {10ms, 40ms};
  traits.service = {500us, 1ms};
  return traits;
}

}  // namespace

// ---- search

SearchNode::SearchNode(simulation::World& world, const Generation& generation, Helm& helm)
    : Node(world, nodes::kSearch, function_node()), generation_(generation), helm_(helm) {
  declare(kAltitude, 2.0);
}

void SearchNode::on_start() {
  spiral_ = {};
  every(from_seconds(random().uniform()), 1s, [this] { tick(); });
}

void SearchNode::on_activate() {
  if (!generation_.keeps_spiral) spiral_ = {};
}

void SearchNode::tick() {
  if (!is_active()) return;
  if (!spiral_.has_begun()) {
    const auto centre = helm_.centre();
    if (!centre) return;
    spiral_.restart(*centre);
  }
  const double altitude = std::get<double>(*parameter(kAltitude));
  if (const auto goal = spiral_.tick(helm_.seen(), altitude)) helm_.go_to(*goal);
}

// ---- follow

FollowNode::FollowNode(simulation::World& world, Topics& topics, const Generation& generation,
                       Helm& helm)
    : Node(world, nodes::kFollow, function_node()),
      generation_(generation),
      helm_(helm),
      distance_topic_(*this, topics.distance),
      inspected_topic_(*this, topics.inspected) {}

void FollowNode::on_start() {
  has_path_ = false;
  path_.clear();
  goal_.reset();
  constexpr Duration kPeriod = 2s;
  every(from_seconds(seconds(kPeriod) * random().uniform()), kPeriod, [this] { poll(); });
}

void FollowNode::on_activate() {
  if (!has_path_ && helm_.found()) {
    const auto path = inspection_path(*helm_.found());
    path_.assign(path.begin(), path.end());
    has_path_ = true;
  }
  // A path is followed from where it was left; the point on the way is lost, or not.
  if (goal_ && !generation_.loses_point) path_.push_front(*goal_);
  goal_.reset();
  last_.reset();
  distance_ = 0;
  post([this] { go_on(); });
}

bool FollowNode::is_there() const {
  constexpr double kTolerance = 0.5;
  return is_near(helm_.seen(), *goal_, kTolerance);
}

// Every two seconds, a waiting function checks whether the vehicle has arrived.
void FollowNode::poll() {
  constexpr int kPatience = 10;
  if (!is_active() || !goal_) return;
  if (is_there()) return go_on();
  if (++polls_ <= kPatience) return;
  polls_ = 0;
  helm_.go_to(*goal_);
}

// To the next point, and at once to the one after it if the vehicle is there already.
void FollowNode::go_on() {
  constexpr double kHeight = 1.25;  // above the seabed
  if (!is_active()) return;
  do {
    if (goal_) {
      if (last_) distance_ += std::hypot(goal_->x - last_->x, goal_->y - last_->y);
      last_ = goal_;
      distance_topic_.publish({distance_});
    }
    if (path_.empty()) {
      goal_.reset();
      if (has_path_) inspected_topic_.publish({true});
      return;
    }
    goal_ = {path_.front().x, path_.front().y, kSeabed + kHeight};
    path_.pop_front();
    polls_ = 0;
    helm_.go_to(*goal_);
  } while (is_there());
}

// ---- recover

MotionNode::MotionNode(simulation::World& world, const Generation& generation, Helm& helm)
    : Node(world, nodes::kMotion, function_node()), generation_(generation), helm_(helm) {}

void MotionNode::on_activate() {
  ++activations_;
  world().after(10s, [this, activation = activations_] { recover(1, activation); });
}

void MotionNode::on_deactivate() {
  if (!generation_.recovers_anyway) ++activations_;
}

void MotionNode::recover(int thruster, int activation) {
  const bool is_cancelled = !generation_.recovers_anyway && activation != activations_;
  if (is_cancelled || process() != ProcessState::kRunning || thruster > kThrusters) return;
  helm_.recover(thruster);
  world().diagnose("", std::string(diagnostics::kThrusterKey) + std::to_string(thruster),
                   std::string(diagnostics::kRecovered));
  world().after(250ms, [this, thruster, activation] { recover(thruster + 1, activation); });
}

// ---- recharge

RechargeNode::RechargeNode(simulation::World& world, const Generation& generation, Helm& helm)
    : Node(world, nodes::kRecharge, function_node()), generation_(generation), helm_(helm) {}

void RechargeNode::on_start() {
  every(from_seconds(seconds(generation_.recharge_poll) * random().uniform()),
        generation_.recharge_poll, [this] { tick(); });
}

void RechargeNode::tick() {
  constexpr Position kStation = {-3, -2, -18.75};
  constexpr double kTolerance = 0.5;
  if (!is_active()) return;
  helm_.go_to(kStation);
  if (is_near(helm_.seen(), kStation, kTolerance)) helm_.recharge();
}

}  // namespace culprit::suave::model
