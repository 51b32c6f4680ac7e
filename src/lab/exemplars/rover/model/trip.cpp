#include "exemplars/rover/model/trip.h"

#include <cmath>

namespace culprit::rover::model {
namespace {

using namespace std::chrono_literals;

// The mean way between two goals, by path_search; the live rover reaches one in 20 s.
constexpr double kLength = 7;
constexpr double kSpread = 0.3;       // share
constexpr Duration kTurnsFirst = 2s;  // towards the path, at kMostTurn (pursuit.cpp)
constexpr double kMostTurn = 1.2;
constexpr double kBends = 0.3;     // radians a second while it drives
constexpr double kOnBends = 0.85;  // of the speed

}  // namespace

std::optional<Trip::Command> Trip::step(Time now, const Works& works) {
  if (!works.navigator && doing_ != Doing::kNothing) finish(GoalStatus::kAborted);
  if (works.navigator && works.in_map && doing_ != Doing::kNothing) heard_ = now;
  if (now >= later(asked_, 500ms)) {
    asked_ = now;
    if (doing_ == Doing::kNothing || now > later(heard_, 6s)) send_goal(now, works);
  }
  if (works.navigator) navigate(now, works);
  if (!works.controller) is_following_ = false;
  if (is_following_) return follow(now, works);
  if (!is_backing_ || !works.behavior) return std::nullopt;
  return recoveries_ % 3 == 1 ? Command{-0.15, 0} : Command{0, 1};
}

void Trip::forget() {
  doing_ = Doing::kNothing;
  goals_.clear();
  has_news_ = true;
}

void Trip::send_goal(Time now, const Works& works) {
  if (!works.navigator) return;
  if (doing_ != Doing::kNothing) finish(GoalStatus::kAborted);
  if (left_ <= 0) left_ = kLength * random_.uniform(1 - kSpread, 1 + kSpread);
  goals_.push_back({++last_goal_, GoalStatus::kExecuting});
  if (goals_.size() > 10) goals_.erase(goals_.begin());
  has_news_ = true;
  doing_ = Doing::kPlanning;
  recoveries_ = 0;
  due_ = heard_ = began_ = now;
}

void Trip::navigate(Time now, const Works& works) {
  if (doing_ == Doing::kNothing || now < due_) return;
  if (doing_ == Doing::kRecovering) {
    is_backing_ = false;
    doing_ = Doing::kPlanning;
  }
  // A planner that is not active refuses; one that does not answer is waited for.
  if (!works.planner || !works.in_map) return recover(now);
  doing_ = Doing::kFollowing;
  due_ = later(now, 1s);
  if (!works.controller || is_following_) return;
  is_following_ = true;
  well_ = progress_ = now;
  since_progress_ = 0;
}

void Trip::recover(Time now) {
  is_following_ = false;
  if (++recoveries_ > 6) return finish(GoalStatus::kAborted);
  doing_ = Doing::kRecovering;
  is_backing_ = recoveries_ % 3 != 0;
  due_ = later(now, 2s);
}

void Trip::finish(GoalStatus status) {
  doing_ = Doing::kNothing;
  is_following_ = is_backing_ = false;
  if (status == GoalStatus::kSucceeded) ++reached_;
  if (status == GoalStatus::kAborted) ++failed_;
  if (!goals_.empty()) goals_.back().status = status;
  has_news_ = true;
}

std::optional<Trip::Command> Trip::follow(Time now, const Works& works) {
  since_progress_ += works.moved;
  if (since_progress_ > 0.2 || now < later(began_, kTurnsFirst)) {
    since_progress_ = 0;
    progress_ = now;
  }
  if (!works.in_map || !works.sees) {
    if (now > later(well_, 3s)) recover(now);
    return Command{};
  }
  well_ = now;
  const bool is_stuck = now > later(progress_, 8s);
  if (!is_stuck && left_ > 0) return drive(now, works);
  if (is_stuck) recover(now);
  if (!is_stuck) finish(GoalStatus::kSucceeded);
  return Command{};
}

Trip::Command Trip::drive(Time now, const Works& works) {
  const double since = seconds(now - began_);
  Command command{kOnBends * works.max_speed, kBends * std::sin(since)};
  if (now < later(began_, kTurnsFirst)) command = {0, kMostTurn};
  if (works.oscillates) {
    const bool is_left = static_cast<std::int64_t>(since * 10) % 2 == 0;
    command.turn = is_left ? kMostTurn : -kMostTurn;
  }
  if (!works.is_lost) left_ -= works.moved;
  return command;
}

}  // namespace culprit::rover::model
