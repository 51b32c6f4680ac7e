// The pursuit of one goal: which request comes next, and when it is reached or given up.
//
// A state machine without I/O. It waits for one request at a time, and sends each changing request
// at most once. But a stop is sent anew, as a kill, where it is proven meanwhile that the node hangs; and a
// start where the process ended and may need several tries (READY).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "execute/goal.h"

namespace culprit::execute {

// A whole number for a parameter that holds numbers, and the other way round where nothing is lost:
// ROS parameters are strictly typed, rule files are not.
Value in_type_of(const Value& value, const Value& present);

class Pursuit {
 public:
  using Request = decltype(Command::what);

  static constexpr Duration kPause = std::chrono::milliseconds(100);  // between two looks

  // `is_last_resort`: the request is sent although its component hangs, is stopped, or does not answer when it
  // is looked at. It obeys if it goes on.
  Pursuit(Goal goal, ComponentId component, Time now, bool is_last_resort = false);

  // The next request, if one is due. `knowledge` answers for processes and the graph.
  // @pre is_under_way()
  std::optional<Request> advance(const Knowledge& knowledge, Time now);

  // Answers until `now` may have been lost.
  void restart(Time now);

  // The answer to the last request.
  void answered(const Reply& reply, Time now);

  bool is_under_way() const { return status_ == Status::kUnderWay; }
  bool is_reached() const { return status_ == Status::kReached; }
  // Why the goal was given up; or what was odd about reaching it; or empty.
  const std::string& remark() const { return remark_; }

  // Its component is not there any more, or hangs, so that there is nothing to look at or to change.
  bool is_lost(const Knowledge& knowledge) const;

  // Its node was asked to end politely, and is proven to hang since: it is to be killed.
  bool must_insist(const Knowledge& knowledge) const;

  // Somebody else has changed, meanwhile, what it changes.
  bool met_driver() const { return driver_seen_; }

  // It was given up although nothing had gone wrong but that it took too long.
  bool took_too_long() const { return took_too_long_; }

  // It was given up because its process hangs (LifecycleGoal::hangs_after).
  bool found_hung() const { return found_hung_; }

  // It was given up because something else sets back what it sets.
  bool met_rival() const { return met_rival_; }

  // The value that was read before the first change.
  const std::optional<Reply>& before() const { return before_; }
  bool has_changed_anything() const { return !sent_.empty(); }

  // How long the answer to `request` may take.
  Duration timeout(const Request& request) const;
  // When to advance even if nothing was observed.
  Time next_deadline() const;

  // ParameterGoal, reached: what it was set to; empty if it reads back as something else.
  std::optional<Value> left() const;

  // When the last change was asked for, and the first; kNever before.
  Time changed() const { return changed_; }
  Time first_changed() const { return first_changed_; }
  const Goal& goal() const { return goal_; }
  ComponentId component() const { return component_; }

 private:
  enum class Status : std::uint8_t { kUnderWay, kReached, kGivenUp };
  enum class Step : std::uint8_t { kLook, kLooking, kDecide, kChanging, kPausing };

  std::optional<Request> decide(const Knowledge& knowledge, Time now);
  std::optional<Request> pursue(const ParameterGoal& goal, Time now);
  std::optional<Request> pursue(const LifecycleGoal& goal, Time now);
  std::optional<Request> pursue(const ModeGoal& goal, Time now);
  std::optional<Request> pursue(const ServiceGoal& goal, Time now);
  std::optional<Request> pursue(const GoneGoal& goal, const Knowledge& knowledge, Time now);
  std::optional<Request> pursue(const PresentGoal& goal, const Knowledge& knowledge, Time now);
  std::optional<Request> start_again(const PresentGoal& goal, std::string why, Time now);
  std::optional<Request> wait_until(Time at);

  bool is_hung(const Knowledge& knowledge, Time now) const;
  bool would_fight(const Knowledge& knowledge) const;
  std::optional<Request> change_unseen(const Knowledge& knowledge, Time now);
  std::optional<Request> change(Request request, Time now);
  std::optional<Request> look_again(Time now);
  std::optional<Request> reach(std::string remark = "");
  std::optional<Request> give_up(std::string reason);
  bool is_left() const;
  bool may_drive_itself(const Knowledge& knowledge) const;
  bool has_sent(Transition transition) const;

  Goal goal_;
  ComponentId component_;
  Status status_ = Status::kUnderWay;
  Step step_ = Step::kLook;
  Time begun_;
  Time deadline_;
  Time first_changed_ = kNever;
  Time changed_ = kNever;  // when the last change was asked for
  Time wake_ = kNever;     // of the answer, or of the pause
  std::optional<Reply> before_;
  std::optional<Reply> seen_;    // the last look
  std::optional<Reply> answer_;  // to the last change
  std::vector<Request> sent_;    // changes
  std::optional<Value> wanted_;  // ParameterGoal, once the present value is known
  std::string remark_;
  bool is_last_resort_ = false;
  bool met_rival_ = false;
  bool took_too_long_ = false;
  bool owed_answer_ = false;  // GoneGoal: its answer was overdue when it was asked to end
  Lifecycle last_ = Lifecycle::kUnknown;       // LifecycleGoal: the last primary state seen
  Lifecycle asked_for_ = Lifecycle::kUnknown;  // where the last transition leads
  bool driver_seen_ = false;
  Time again_at_ = kNever;       // PresentGoal: the next try
  Time held_until_ = kLongAgo;   // nothing is asked for
  Time loads_until_ = kLongAgo;  // it may be too busy to answer
  int unanswered_ = 0;           // questions in a row
  Time answered_;                // when the last look was answered; at first when it begins
  bool found_hung_ = false;
};

}  // namespace culprit::execute
