#include "managers/paced_manager.h"

#include <algorithm>
#include <array>

namespace culprit::study {
namespace {

using std::chrono::milliseconds;

struct Named {
  std::string_view name;
  Pace pace;
};

// A tick of the tree; an inference every 1.5 s; about thirty transactions of 24 to 48 ms; ticks at
// the 100 Hz of BehaviorTree.ROS2's execution server, which ReBeT's is, one to ask for an
// adaptation and one to see the answer.
constexpr Pace kTree{milliseconds(10), {milliseconds(10), {}}};
constexpr std::array<Named, 7> kPaces = {
    {{"bt", {milliseconds(150), {}}},
     {"metacontrol", {milliseconds(1500), {milliseconds(600), milliseconds(250)}}},
     {"rosa", {milliseconds(36), {milliseconds(720), milliseconds(720)}}},
     {"rebet", kTree},
     {"rebet-ucb", kTree},
     {"rebet-greedy", kTree},
     {"rebet-random", kTree}}};

}  // namespace

const Pace* find_pace(std::string_view baseline) {
  const auto found = std::find_if(kPaces.begin(), kPaces.end(),
                                  [&](const Named& each) { return each.name == baseline; });
  return found == kPaces.end() ? nullptr : &found->pace;
}

PacedManager::PacedManager(std::unique_ptr<ManagingSystem> inner, const Pace& pace, Time start,
                           std::uint64_t seed)
    : inner_(std::move(inner)),
      pace_(pace),
      random_(seed),
      next_look_(later(start, from_seconds(seconds(pace.period) * random_.uniform()))) {}

std::vector<Command> PacedManager::step(Time now, std::span<const Observation> observations) {
  unseen_.insert(unseen_.end(), observations.begin(), observations.end());
  events_.clear();
  std::vector<Command> commands;
  const bool is_answered =
      std::any_of(observations.begin(), observations.end(),
                  [](const Observation& each) { return std::holds_alternative<Reply>(each.what); });
  const bool looks = is_awake() || now >= next_look_;
  if (looks || is_answered) {
    std::vector<Command> wanted = inner_->step(now, unseen_);
    unseen_.clear();
    events_.assign(inner_->events().begin(), inner_->events().end());
    const bool decides = std::any_of(events_.begin(), events_.end(), [](const Event& event) {
      return std::holds_alternative<StrategyChosen>(event.what);
    });
    const Time out = decides ? later(now, pace_.decision.draw(random_)) : now;
    for (Command& command : wanted) decided_.emplace_back(out, std::move(command));
  }
  while (!is_awake() && next_look_ <= now) next_look_ = later(next_look_, pace_.period);
  release(now, commands);
  return commands;
}

void PacedManager::release(Time now, std::vector<Command>& commands) {
  while (!decided_.empty() && decided_.front().first <= now) {
    commands.push_back(std::move(decided_.front().second));
    decided_.pop_front();
  }
}

Time PacedManager::next_deadline() const {
  const Time next = is_awake() ? inner_->next_deadline() : next_look_;
  return decided_.empty() ? next : std::min(next, decided_.front().first);
}

}  // namespace culprit::study
