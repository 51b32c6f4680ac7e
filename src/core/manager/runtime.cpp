#include "manager/runtime.h"

#include <algorithm>
#include <utility>

namespace culprit {

// Messages that came during a brief one keep their own times.
std::optional<Observation> Runtime::lateness(Time due, Time now) {
  const Duration by = now - due;
  if (by <= kLate) return std::nullopt;
  return Observation{by > Overslept::kBriefly ? now : due, Overslept{by}};
}

void Runtime::run(const std::atomic<bool>& stop, Time end) {
  std::vector<Observation> observations;
  while (!stop && robot_.now() < end) {
    observations.clear();
    const Time next = next_deadline();
    const Time due = std::max(stepped_, next);
    robot_.observe(std::min(end, next), observations);
    const Time now = robot_.now();
    if (auto late = lateness(due, now); late && stepped_ != kLongAgo)
      observations.insert(observations.begin(), std::move(*late));
    take_orders(observations);
    step(observations);
  }
}

void Runtime::step(std::vector<Observation>& observations) {
  const Time begin = robot_.now();
  const Time now = stepped_ = std::max(stepped_, robot_.observed_until());
  const std::vector<Command> commands = manager_.step(now, observations);
  const Step done{now, robot_.now() - begin, observations, commands, manager_.events()};
  if (!commands.empty() && before_commands) before_commands(done);
  for (const Command& command : commands) robot_.execute(command);
  if (on_step) on_step(done);
  if (!manager_.events().empty() && on_events) on_events(manager_.events());
}

Time Runtime::next_deadline() const {
  const Time own = manager_.next_deadline();
  return next_look ? std::min(own, next_look()) : own;
}

void Runtime::submit(Order order) {
  {
    const MutexLock lock(mutex_);
    orders_.push_back(std::move(order));
  }
  robot_.interrupt();
}

void Runtime::take_orders(std::vector<Observation>& observations) {
  const MutexLock lock(mutex_);
  for (Order& order : orders_) observations.push_back({robot_.now(), std::move(order)});
  orders_.clear();
}

}  // namespace culprit
