#include "execute/pursuit.h"

#include <algorithm>
#include <cmath>

#include "base/duration_words.h"
#include "base/invariant.h"
#include "base/value_list.h"
#include "execute/evidence.h"

namespace culprit::execute {

using namespace std::chrono_literals;

namespace {

// A list is a text (base/value_list.h), of which there are several: the one that is read back is written
// as it is, with the elements of its type.
std::optional<Value> list_like(const Value& value, const Value& present) {
  const auto* wanted = std::get_if<std::string>(&value);
  const auto* text = std::get_if<std::string>(&present);
  if (wanted == nullptr || text == nullptr) return std::nullopt;
  auto list = list_from_text(*wanted);
  const auto before = list_from_text(*text);
  if (!list || !before || text_of_list(*before) != *text) return std::nullopt;
  for (Value& each : *list) {
    if (!before->empty()) each = in_type_of(each, before->front());
  }
  return text_of_list(*list);
}

}  // namespace

Value in_type_of(const Value& value, const Value& present) {
  if (auto list = list_like(value, present)) return *list;
  if (const auto* whole = std::get_if<std::int64_t>(&value);
      whole != nullptr && std::holds_alternative<double>(present)) {
    return static_cast<double>(*whole);
  }
  if (const auto* number = std::get_if<double>(&value);
      number != nullptr && std::holds_alternative<std::int64_t>(present)) {
    constexpr double kExact = 9007199254740992.0;  // 2^53
    if (std::nearbyint(*number) == *number && std::fabs(*number) <= kExact)
      return static_cast<std::int64_t>(*number);
  }
  return value;
}

namespace {

std::optional<Value> sum(const Value& present, const Value& change) {
  const auto* whole = std::get_if<std::int64_t>(&present);
  const auto* more = std::get_if<std::int64_t>(&change);
  if (whole != nullptr && more != nullptr) {
    std::int64_t result = 0;
    return __builtin_add_overflow(*whole, *more, &result) ? std::nullopt
                                                          : std::optional<Value>(result);
  }
  const auto number = [](const Value& v) -> std::optional<double> {
    if (const auto* i = std::get_if<std::int64_t>(&v)) return static_cast<double>(*i);
    if (const auto* d = std::get_if<double>(&v)) return *d;
    return std::nullopt;
  };
  const auto a = number(present);
  const auto b = number(change);
  if (!a || !b) return std::nullopt;
  return Value(*a + *b);
}

bool did_not_come(const Reply& reply) {
  return reply.outcome == Outcome::kTimedOut || reply.outcome == Outcome::kUnreachable;
}

// How long a goal that begins with a new process waits for it to come up.
Duration grace(const Goal& goal) {
  const auto* lifecycle = std::get_if<LifecycleGoal>(&goal);
  return lifecycle != nullptr ? lifecycle->grace : Duration::zero();
}

Duration loading(const Goal& goal) {
  const auto* lifecycle = std::get_if<LifecycleGoal>(&goal);
  return lifecycle != nullptr ? lifecycle->loading : Duration::zero();
}

// How many questions in a row may stay without an answer before a goal is given up for that. A network
// loses single answers; a simulated robot loses none.
int most_unanswered(const Knowledge& knowledge) {
  return knowledge.finding > Duration::zero() ? 2 : 1;
}

std::string why(const Reply& reply) {
  if (!reply.text.empty()) return reply.text;
  switch (reply.outcome) {
    case Outcome::kRefused:
      return "it refused";
    case Outcome::kUnreachable:
      return "it cannot be reached";
    case Outcome::kTimedOut:
      return "it did not answer";
    case Outcome::kDone:
      return "";
  }
  return "";
}

}  // namespace

Pursuit::Pursuit(Goal goal, ComponentId component, Time now, bool is_last_resort)
    : goal_(std::move(goal)),
      component_(component),
      begun_(now),
      deadline_(later(now, patience(goal_))),
      is_last_resort_(is_last_resort),
      held_until_(later(now, grace(goal_))),
      loads_until_(later(now, loading(goal_))),
      answered_(now) {}

Duration Pursuit::timeout(const Request& request) const {
  if (std::holds_alternative<StopProcess>(request)) return 12s;
  const auto* present = std::get_if<PresentGoal>(&goal_);
  if (present != nullptr && std::holds_alternative<StartProcess>(request)) return present->answer;
  if (std::holds_alternative<ChangeLifecycle>(request))
    return std::min<Duration>(5s, patience(goal_));
  if (const auto* service = std::get_if<ServiceGoal>(&goal_)) return service->answer;
  const bool is_slow =
      std::holds_alternative<ChangeMode>(request) || std::holds_alternative<StartProcess>(request);
  return is_slow ? 5s : 1s;
}

Time Pursuit::next_deadline() const {
  if (step_ == Step::kLook || step_ == Step::kDecide) return kLongAgo;
  // The patience is looked at only after a look, so it is no time to wake at by itself: a deadline
  // that has passed and is not acted on would keep the manager stepping without end.
  return wake_;
}

void Pursuit::answered(const Reply& reply, Time) {
  // An answer after its time-out finds a pause under way, whose end must stay as it is.
  if (step_ != Step::kLooking && step_ != Step::kChanging) return;
  wake_ = kNever;
  if (step_ == Step::kLooking) {
    seen_ = reply;
    step_ = Step::kDecide;
  } else {
    answer_ = reply;
    step_ = Step::kLook;
  }
}

void Pursuit::restart(Time now) {
  deadline_ = later(now, patience(goal_));
  answered_ = now;
  const bool heard_nothing = step_ == Step::kDecide && seen_ && did_not_come(*seen_);
  if (step_ == Step::kLooking || heard_nothing) step_ = Step::kLook;
  CULPRIT_ASSERT(step_ != Step::kChanging || !sent_.empty());
  if (step_ == Step::kChanging) wake_ = std::max(wake_, later(now, timeout(sent_.back()) + 1s));
}

bool Pursuit::is_lost(const Knowledge& knowledge) const {
  const bool is_of_process =
      std::holds_alternative<GoneGoal>(goal_) || std::holds_alternative<PresentGoal>(goal_);
  const ComponentState& state = knowledge.components[component_];
  const bool is_still_to_be_asked =
      is_last_resort_ && state.may_still_obey() && !has_changed_anything();
  return !is_of_process && state.alive == false && !is_still_to_be_asked;
}

// A node that ends politely answers nothing while it does so. Only one that had not answered before
// is known to hang. systemd, engines and containers end what is theirs in their own way.
bool Pursuit::must_insist(const Knowledge& knowledge) const {
  const auto* stop = sent_.empty() ? nullptr : std::get_if<StopProcess>(&sent_.back());
  if (stop == nullptr || stop->hangs || !owed_answer_ || !is_under_way()) return false;
  const Component& component = knowledge.rules[component_];
  const bool is_ended_by_others =
      component.has_owner() || component.composed || is_container(component_, knowledge.rules);
  const ComponentState& state = knowledge.components[component_];
  return !is_ended_by_others && state.hangs() && (stop->pid == 0 || state.known_pid() == stop->pid);
}

std::optional<Pursuit::Request> Pursuit::advance(const Knowledge& knowledge, Time now) {
  CULPRIT_ASSERT(is_under_way());
  if (is_lost(knowledge)) {
    const ComponentState& state = knowledge.components[component_];
    took_too_long_ = state.hangs() && has_changed_anything();
    if (state.hangs()) return give_up("it does not answer any more");
    if (state.in_graph) return give_up("its process is stopped");
    const std::string& how = state.process_remark;
    return give_up("it is not there any more" + (how.empty() ? "" : ": " + how) +
                   (may_drive_itself(knowledge)
                        ? "; does it activate itself? Then it is LIFECYCLE self, not managed"
                        : ""));
  }
  if (must_insist(knowledge)) {
    answer_.reset();
    return change(StopProcess{std::get<StopProcess>(sent_.back()).pid, true}, now);
  }
  // An adapter that never answers must not hold a component for ever.
  if (wake_ <= now && (step_ == Step::kLooking || step_ == Step::kChanging)) {
    answered({{}, Outcome::kTimedOut, {}, ""}, now);
  }
  if (step_ == Step::kPausing && (wake_ <= now || !look_for(goal_))) step_ = Step::kLook;
  if (const auto* parameter = std::get_if<ParameterGoal>(&goal_);
      step_ == Step::kLook && sent_.empty() && parameter != nullptr && parameter->present) {
    seen_ = {{}, Outcome::kDone, *parameter->present, ""};
    step_ = Step::kDecide;
  }
  if (step_ == Step::kLook && knowledge.components[component_].alive == false) {
    if (auto request = change_unseen(knowledge, now)) return request;
  }
  if (step_ == Step::kLook) {
    const auto look = look_for(goal_);
    step_ = look ? Step::kLooking : Step::kDecide;
    if (look) {
      Request request = std::visit([](const auto& l) { return Request(l); }, *look);
      wake_ = later(now, timeout(request) + 1s);
      return request;
    }
  }
  return step_ == Step::kDecide ? decide(knowledge, now) : std::nullopt;
}

std::optional<Pursuit::Request> Pursuit::decide(const Knowledge& knowledge, Time now) {
  const ComponentState& state = knowledge.components[component_];
  if (std::holds_alternative<ModeGoal>(goal_) && has_changed_anything() &&
      !state.alive.value_or(true))
    return give_up("the node that changes its mode is not alive");
  if (const auto* gone = std::get_if<GoneGoal>(&goal_)) return pursue(*gone, knowledge, now);
  if (const auto* present = std::get_if<PresentGoal>(&goal_))
    return pursue(*present, knowledge, now);
  if (const auto* service = std::get_if<ServiceGoal>(&goal_)) return pursue(*service, now);
  // The change was not sent, because no node was there to receive it.
  if (answer_ && answer_->outcome == Outcome::kUnreachable) {
    if (now >= std::min(loads_until_, deadline_)) return give_up(why(*answer_));
    CULPRIT_ASSERT(!sent_.empty());  // it is the answer to a change
    sent_.pop_back();
    answer_.reset();
    return look_again(now);
  }
  if (is_hung(knowledge, now)) {
    found_hung_ = true;
    return give_up("its process runs, but it does not answer");
  }
  if (did_not_come(*seen_)) {
    if (auto request = change_unseen(knowledge, now)) return request;
    // Before the change: no node is there to change, unless it is still coming up. After it: the
    // answer may just be late.
    const bool may_come =
        now < std::max(held_until_, loads_until_) || ++unanswered_ < most_unanswered(knowledge);
    if (now >= deadline_ || (!has_changed_anything() && !may_come)) return give_up(why(*seen_));
    return look_again(now);
  }
  unanswered_ = 0;
  answered_ = now;
  if (seen_->outcome == Outcome::kRefused) {
    // A process that does not know the parameter has nothing that would have to be undone.
    const auto* parameter = std::get_if<ParameterGoal>(&goal_);
    const bool restores = parameter != nullptr && parameter->kind == ParameterGoal::Kind::kRestore;
    return restores ? reach("nothing to restore: " + why(*seen_)) : give_up(why(*seen_));
  }
  if (!before_ && !has_changed_anything()) before_ = seen_;
  if (!has_changed_anything() && would_fight(knowledge)) {
    met_rival_ = true;
    return give_up("another program sets it back; culprit leaves it alone");
  }
  if (const auto* parameter = std::get_if<ParameterGoal>(&goal_)) return pursue(*parameter, now);
  if (const auto* lifecycle = std::get_if<LifecycleGoal>(&goal_)) return pursue(*lifecycle, now);
  return pursue(std::get<ModeGoal>(goal_), now);
}

// Before the change: a node with one thread answers nothing while it changes its lifecycle.
bool Pursuit::is_hung(const Knowledge& knowledge, Time now) const {
  const auto* lifecycle = std::get_if<LifecycleGoal>(&goal_);
  const ComponentState& state = knowledge.components[component_];
  if (lifecycle == nullptr || !lifecycle->hangs_after || has_changed_anything() ||
      seen_->outcome != Outcome::kTimedOut || !state.answers_probes)
    return false;
  const bool is_in_transition = state.changes_until != kNever && state.changes_until > now;
  return !is_in_transition &&
         later(std::max(answered_, state.answered), *lifecycle->hangs_after) <= now;
}

bool Pursuit::would_fight(const Knowledge& knowledge) const {
  const auto* mode = std::get_if<ModeGoal>(&goal_);
  const auto* value = std::get_if<Value>(&seen_->value);
  const auto* present = value == nullptr ? nullptr : std::get_if<std::string>(value);
  return mode != nullptr && present != nullptr &&
         knowledge.rivals.would_fight(component_, *present, mode->mode,
                                      knowledge.began(component_));
}

std::optional<Pursuit::Request> Pursuit::pursue(const ParameterGoal& goal, Time now) {
  const auto* present = std::get_if<Value>(&seen_->value);
  if (present == nullptr) return give_up(goal.name + " has no value");
  if (!wanted_) {
    const bool adds = goal.kind == ParameterGoal::Kind::kAdd;
    const auto target = adds ? sum(*present, goal.value) : std::optional(goal.value);
    if (!target)
      return give_up(goal.name + " is " + to_string(*present) + " and cannot be increased");
    wanted_ = in_type_of(*target, *present);
  }
  const bool is_there = *present == *wanted_;
  if (!has_changed_anything() && !is_there && goal.left && *present != *goal.left)
    return give_up("something else has set it to " + to_string(*present) + " since");
  if (!has_changed_anything() && !(is_there && goal.kind == ParameterGoal::Kind::kRestore)) {
    return change(SetParameter{goal.name, *wanted_}, now);
  }
  if (is_there) return reach();
  if (answer_->outcome == Outcome::kRefused) return give_up(why(*answer_));
  // Some parameters start a routine and reset themselves. The symptom shows whether it helped.
  if (answer_->outcome == Outcome::kDone)
    return reach("accepted, but it reads back " + to_string(*present));
  return look_again(now);
}

std::optional<Pursuit::Request> Pursuit::pursue(const LifecycleGoal& goal, Time now) {
  const auto* state = std::get_if<Lifecycle>(&seen_->value);
  const Lifecycle present = state != nullptr ? *state : Lifecycle::kUnknown;
  if (present == goal.target) return reach();
  if (present == Lifecycle::kFinalized) return give_up("it is finalized");
  if (present == Lifecycle::kUnknown || present == Lifecycle::kTransition) return look_again(now);
  const bool is_refused = answer_ && answer_->outcome == Outcome::kRefused;
  const bool has_moved = last_ != Lifecycle::kUnknown && present != last_;
  if (has_moved && has_changed_anything() && present == Lifecycle::kUnconfigured)
    return give_up("it fell back to unconfigured when asked to " +
                   to_string(Command{{}, {}, sent_.back(), {}}));
  // A transition that culprit did not request, or that was refused, and that happened all the same,
  // has another driver. Two drivers of one node's lifecycle make each other fail, so culprit leaves
  // it to the other one for a while. A node that is just started and is found beyond *unconfigured*
  // was taken there by another driver.
  const bool is_led = goal.may_have_driver && last_ == Lifecycle::kUnknown &&
                      present == Lifecycle::kInactive && !has_changed_anything();
  if (is_led) held_until_ = std::max(held_until_, later(now, goal.patience / 2));
  if (has_moved && (present != asked_for_ || is_refused))
    held_until_ = later(now, goal.patience / 2);
  driver_seen_ |= is_led || (has_moved && (present != asked_for_ || is_refused));
  last_ = present;
  if (goal.is_left_to_others || now < held_until_) return look_again(now);
  const Transition next = present == Lifecycle::kUnconfigured ? Transition::kConfigure
                          : present == Lifecycle::kInactive   ? Transition::kActivate
                                                              : Transition::kDeactivate;
  if (!has_sent(next)) {
    asked_for_ = next == Transition::kActivate ? Lifecycle::kActive : Lifecycle::kInactive;
    return change(ChangeLifecycle{next}, now);
  }
  if (answer_->outcome == Outcome::kRefused)
    return give_up("it refused to " + to_string(Command{{}, {}, sent_.back(), {}}));
  return look_again(now);
}

std::optional<Pursuit::Request> Pursuit::pursue(const ModeGoal& goal, Time now) {
  const auto* value = std::get_if<Value>(&seen_->value);
  if (value != nullptr && *value == Value(goal.mode)) return reach();
  if (!has_changed_anything()) return change(ChangeMode{goal.mode}, now);
  if (answer_->outcome == Outcome::kRefused) return give_up(why(*answer_));
  return look_again(now);
}

std::optional<Pursuit::Request> Pursuit::pursue(const ServiceGoal& goal, Time now) {
  if (!has_changed_anything()) return change(CallService{goal.service, goal.request}, now);
  return answer_->outcome == Outcome::kDone ? reach() : give_up(why(*answer_));
}

std::optional<Pursuit::Request> Pursuit::pursue(const GoneGoal& goal, const Knowledge& knowledge,
                                                Time now) {
  const ComponentState& state = knowledge.components[component_];
  const bool is_replaced = goal.pid != 0 && state.in_graph && state.known_pid() != goal.pid;
  const bool was_ended = answer_ && answer_->outcome == Outcome::kDone;
  if (is_replaced && (!has_changed_anything() || was_ended)) return reach();
  // systemd knows it by its unit, also if it is another user's.
  if (state.in_graph && state.known_pid() == 0 && !knowledge.rules[component_].has_owner())
    return give_up("its process is not known; is it on another machine?");
  if (!has_changed_anything()) {
    owed_answer_ = owes_answer(state, now);
    return change(
        StopProcess{goal.pid != 0 ? goal.pid : state.known_pid(), goal.hangs || state.hangs()},
        now);
  }
  const bool is_gone = !state.in_graph && state.process == ProcessState::kGone;
  // Where the operating system is asked, its word is needed too: a new process must not begin
  // beside the old one because of a wrong answer.
  const bool still_runs = knowledge.rules[component_].composed
                              ? state.in_graph  // the process is its container's
                              : state.pid != 0 && state.process != ProcessState::kGone;
  if (is_gone || (answer_->outcome == Outcome::kDone && !still_runs)) return reach();
  const bool may_come =
      answer_->outcome == Outcome::kTimedOut || answer_->outcome == Outcome::kDone;
  return may_come ? look_again(now) : give_up(why(*answer_));
}

std::optional<Pursuit::Request> Pursuit::pursue(const PresentGoal& goal, const Knowledge& knowledge,
                                                Time now) {
  const ComponentState& state = knowledge.components[component_];
  const bool is_another = (goal.instead_of && state.known_pid() != *goal.instead_of) ||
                          (goal.instead_of_seen && state.node_seen > *goal.instead_of_seen);
  const bool is_there = state.in_graph && is_another;
  if (is_there && !has_changed_anything()) return reach();
  // Started before culprit ended, and not in the graph yet. If it was stopped since, none is begun
  // beside it either.
  const bool is_coming = goal.instead_of && state.pid != 0 && state.pid != *goal.instead_of &&
                         state.process != ProcessState::kGone && !state.in_graph;
  if (is_coming && !has_changed_anything()) return look_again(now);
  if (!has_changed_anything() && now < goal.not_before) return wait_until(goal.not_before);
  if (!has_changed_anything()) return change(StartProcess{}, now);
  if (state.in_graph && state.node_seen >= begun_) return reach();
  // Its container says that it is loaded: before culprit looked, perhaps.
  if (state.in_graph && knowledge.rules[component_].composed && answer_->outcome == Outcome::kDone)
    return reach();
  if (did_not_come(*answer_) || answer_->outcome == Outcome::kRefused)
    return give_up(why(*answer_));
  const auto* pid = std::get_if<Value>(&answer_->value);
  const bool is_it = pid != nullptr && *pid == Value(std::int64_t{state.pid});
  if (is_it && state.process == ProcessState::kRunning)
    deadline_ = std::max(deadline_, later(changed_, goal.longest));
  if (is_it && state.worked >= changed_)
    deadline_ = std::max(deadline_, std::min(later(state.worked, goal.patience),
                                             later(changed_, PresentGoal::kMost)));
  const bool has_ended = state.process == ProcessState::kGone && is_it;
  if (has_ended) return start_again(goal, "it exited at once: " + state.process_remark, now);
  return look_again(now);
}

// The last try is made when the time is over.
std::optional<Pursuit::Request> Pursuit::start_again(const PresentGoal& goal, std::string why,
                                                     Time now) {
  if (again_at_ == kNever) {
    if (now >= goal.tries_until) return give_up(std::move(why));
    const auto tries = static_cast<int>(std::min<std::size_t>(sent_.size() - 1, 10));
    again_at_ = std::min(later(now, PresentGoal::kPause * (1 << tries)), goal.tries_until);
  }
  if (now < again_at_) return wait_until(again_at_);
  again_at_ = kNever;
  answer_.reset();
  return change(StartProcess{}, now);
}

std::optional<Pursuit::Request> Pursuit::wait_until(Time at) {
  wake_ = at;
  step_ = Step::kPausing;
  return std::nullopt;
}

// The first change of a last resort, without what the component is now. It cannot be added to what is not known.
std::optional<Pursuit::Request> Pursuit::change_unseen(const Knowledge& knowledge, Time now) {
  if (!is_last_resort_ || has_changed_anything() ||
      !knowledge.components[component_].may_still_obey())
    return std::nullopt;
  if (const auto* parameter = std::get_if<ParameterGoal>(&goal_)) {
    if (parameter->kind != ParameterGoal::Kind::kSet) return std::nullopt;
    wanted_ = parameter->value;
    return change(SetParameter{parameter->name, *wanted_}, now);
  }
  if (const auto* lifecycle = std::get_if<LifecycleGoal>(&goal_)) {
    if (lifecycle->target != Lifecycle::kInactive) return std::nullopt;
    asked_for_ = Lifecycle::kInactive;
    return change(ChangeLifecycle{Transition::kDeactivate}, now);
  }
  if (const auto* mode = std::get_if<ModeGoal>(&goal_)) return change(ChangeMode{mode->mode}, now);
  return std::nullopt;
}

std::optional<Pursuit::Request> Pursuit::change(Request request, Time now) {
  CULPRIT_ASSERT(is_under_way());  // a goal that is over would change the robot
  changed_ = now;
  first_changed_ = std::min(first_changed_, now);
  deadline_ = later(now, patience(goal_));
  wake_ = later(now, timeout(request) + 1s);
  step_ = Step::kChanging;
  sent_.push_back(request);
  return request;
}

std::optional<Pursuit::Request> Pursuit::look_again(Time now) {
  if (now >= deadline_) {
    took_too_long_ = has_changed_anything();
    const bool was_accepted = answer_ && answer_->outcome == Outcome::kDone;
    return give_up((was_accepted ? "it accepted and did nothing: not " : "not ") + describe(goal_) +
                   " after " + in_words(now - (sent_.empty() ? begun_ : changed_)) +
                   (is_left() ? "; its driver did not bring it up (LIFECYCLE)" : ""));
  }
  wake_ = std::min(later(now, kPause), deadline_);
  step_ = Step::kPausing;
  return std::nullopt;
}

std::optional<Pursuit::Request> Pursuit::reach(std::string remark) {
  status_ = Status::kReached;
  remark_ = std::move(remark);
  return std::nullopt;
}

std::optional<Pursuit::Request> Pursuit::give_up(std::string reason) {
  status_ = Status::kGivenUp;
  remark_ = std::move(reason);
  return std::nullopt;
}

std::optional<Value> Pursuit::left() const {
  return is_reached() && remark_.empty() ? wanted_ : std::nullopt;
}

bool Pursuit::is_left() const {
  const auto* lifecycle = std::get_if<LifecycleGoal>(&goal_);
  return lifecycle != nullptr && lifecycle->is_left_to_others;
}

// The rules say that culprit drives it, and it ended when culprit did.
bool Pursuit::may_drive_itself(const Knowledge& knowledge) const {
  return std::holds_alternative<LifecycleGoal>(goal_) && has_changed_anything() &&
         knowledge.rules[component_].lifecycle == LifecycleDriver::kManaged;
}

bool Pursuit::has_sent(Transition transition) const {
  return std::any_of(sent_.begin(), sent_.end(), [&](const Request& request) {
    const auto* change = std::get_if<ChangeLifecycle>(&request);
    return change != nullptr && change->transition == transition;
  });
}

}  // namespace culprit::execute
