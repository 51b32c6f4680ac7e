#include "managers/rosa_manager.h"

#include <algorithm>

#include "exemplars/suave/model/visibility.h"

namespace culprit::study {
namespace {

// A transaction of the database, with inference.
constexpr double kTransactionSec = 0.024;
constexpr double kTransactionSpreadSec = 0.024;

// How many each service call takes.
constexpr int kInsert = 3;
constexpr int kInsertUnmodelled = 1;  // of an attribute that the model does not have
constexpr int kPlanningQueries = 7;
constexpr int kSelect = 10;
constexpr int kFetchPlan = 6;
constexpr int kWriteBack = 6;
constexpr int kFeasible = 1;
constexpr int kRequestAction = 4;
constexpr int kCancelAction = 6;

// A subscription keeps the last ten messages (ROS 2's default); who is too slow loses the oldest.
constexpr std::size_t kQueue = 10;

constexpr Duration kTick = std::chrono::milliseconds(150);
constexpr Duration kStartCheck = std::chrono::seconds(1);
constexpr Duration kTimeout = std::chrono::seconds(5);

}  // namespace

RosaManager::RosaManager(const Setting& setting) : SuaveManager(setting) {
  for (const char* node : {"search_node", "follow_node", "motion_node", "recharge_node"})
    selected_.is_active[node] = false;
  active_ = selected_;
  run(monitor());
  run(plan());
  run(execute());
  run(lead());
}

Routine RosaManager::transact(int transactions) {
  co_await enter(base_);
  double time = 0;
  for (int i = 0; i < transactions; ++i)
    time += kTransactionSec + kTransactionSpreadSec * random().uniform();
  co_await sleep(from_seconds(time));
  leave(base_);
}

void RosaManager::on_signal(const std::string& name, const Value& value) {
  SuaveManager::on_signal(name, value);
  const bool is_attribute = name == "visibility" || name == "battery";
  const bool is_status = name.starts_with("thruster_") &&
                         (value == Value(std::string(suave::model::diagnostics::kFailed)) ||
                          value == Value(std::string(suave::model::diagnostics::kRecovered)));
  if (!is_attribute && !is_status) return;
  inbox_.push_back({name, value});
  if (inbox_.size() > kQueue) inbox_.pop_front();
}

Routine RosaManager::monitor() {
  for (;;) {
    while (inbox_.empty()) co_await news();
    const Message message = inbox_.front();
    inbox_.pop_front();
    const bool is_modelled = message.signal != "battery" || has_battery();
    co_await transact(is_modelled ? kInsert : kInsertUnmodelled);
    if (message.signal == "visibility") {
      visibility_ = std::get<double>(message.value);
    } else if (message.signal == "battery") {
      battery_ = std::get<double>(message.value);
    } else {
      thrusters_[message.signal] =
          message.value == Value(std::string(suave::model::diagnostics::kFailed));
    }
    is_plan_wanted_ = true;
    ring(plan_wanted_);
  }
}

Routine RosaManager::plan() {
  for (;;) {
    while (!is_plan_wanted_) co_await hear(plan_wanted_);
    is_plan_wanted_ = false;
    co_await transact(kPlanningQueries);
    const Configuration wanted = best();
    if (wanted == selected_ && active_ == selected_) continue;
    co_await transact(kSelect);
    selected_ = wanted;
    is_plan_pending_ = true;
    ring(plan_pending_);
  }
}

Routine RosaManager::execute() {
  for (;;) {
    while (!is_plan_pending_) co_await hear(plan_pending_);
    is_plan_pending_ = false;
    co_await transact(kFetchPlan);
    const Configuration wanted = selected_;
    co_await apply(wanted);
    co_await transact(kWriteBack);
  }
}

// Obsolete nodes are deactivated first. A change that fails is tried again with the next plan.
Routine RosaManager::apply(Configuration wanted) {
  for (const bool is_activation : {false, true}) {
    for (const auto& [name, is_active] : wanted.is_active) {
      const std::string node = name;
      if (is_active != is_activation || active_.is_active[node] == is_active) continue;
      bool is_done = true;
      if (is_activation) {
        co_await activate(node, &is_done);
      } else {
        const Request off = ChangeLifecycle{Transition::kDeactivate};
        (void)co_await ask(node, off, kTimeout);
      }
      if (is_done) active_.is_active[node] = is_activation;
    }
  }
  if (wanted.altitude && wanted.altitude != active_.altitude) {
    const Request set = SetParameter{suave::model::kAltitude, *wanted.altitude};
    const Reply reply = co_await ask("search_node", set, kTimeout);
    if (reply.outcome == Outcome::kDone) active_.altitude = wanted.altitude;
  }
}

// Starts the process first if there is none.
Routine RosaManager::activate(std::string node, bool* is_done) {
  const Request on = ChangeLifecycle{Transition::kActivate};
  Reply reply = co_await ask(node, on, kTimeout);
  if (reply.outcome == Outcome::kUnreachable || reply.outcome == Outcome::kTimedOut) {
    const Request start = StartProcess{};
    (void)co_await ask(node, start, kTimeout);
    co_await sleep(kStartCheck);
    reply = co_await ask(node, on, kTimeout);
  }
  *is_done = reply.outcome == Outcome::kDone;
}

// The designs and configurations of the highest priority that nothing forbids.
RosaManager::Configuration RosaManager::best() const {
  Configuration best;
  best.is_active["search_node"] = action_ == "search";
  best.is_active["follow_node"] = action_ == "inspect";
  best.is_active["recharge_node"] = action_ == "recharge";
  best.is_active["motion_node"] =
      !action_.empty() && std::any_of(thrusters_.begin(), thrusters_.end(),
                                      [](const auto& thruster) { return thruster.second; });
  best.altitude = selected_.altitude;
  if (action_ != "search") return best;
  for (const suave::model::SearchMode& mode : suave::model::kSearchModes) {
    if (visibility_ < mode.visibility) continue;
    best.altitude = mode.altitude;
    break;
  }
  return best;
}

Routine RosaManager::lead() {
  while (!is_true("guided")) co_await news();
  for (;;) {
    co_await transact(kFeasible);
    const bool is_charged = !has_battery() || battery_ >= kLowBattery;
    const std::string wanted = !is_charged           ? "recharge"
                               : is_true("detected") ? "inspect"
                                                     : "search";
    if (wanted != action_) {
      if (!action_.empty()) co_await transact(kCancelAction);
      co_await transact(kRequestAction);
      action_ = wanted;
      is_plan_wanted_ = true;
      ring(plan_wanted_);
    }
    co_await sleep(kTick);
  }
}

}  // namespace culprit::study
