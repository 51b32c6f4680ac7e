#include "exemplars/rover/bond_manager.h"

#include <algorithm>

namespace culprit::rover {
namespace {

using namespace std::chrono_literals;

constexpr Duration kBondTimeout = 4s;
constexpr Duration kRespawn = 10s;
constexpr Duration kLooks = 200ms;

}  // namespace

BondManager::BondManager(Servers servers, bool has_bonds)
    : servers_(std::move(servers)), has_bonds_(has_bonds), heard_(servers_.count, kLongAgo) {}

void BondManager::begin_active(Time now) {
  phase_ = Phase::kActive;
  std::ranges::fill(heard_, now);
}

void BondManager::begin(Time now) {
  phase_ = Phase::kWaiting;
  changes_.clear();
  requests_.clear();
  answer_ = nullptr;
  blocked_on_.reset();
  due_ = now;
}

bool BondManager::are_all_there() const {
  for (std::size_t s = 0; s < servers_.count; ++s) {
    if (servers_.reach(s) == Reach::kNobody) return false;
  }
  return true;
}

// Whether the process that it waits for still does not answer. One that is replaced never will.
bool BondManager::is_blocked() {
  if (!blocked_on_) return false;
  const std::size_t server = changes_.front().server;
  const bool answers =
      servers_.pid(server) == *blocked_on_ && servers_.reach(server) == Reach::kAnswers;
  if (answers) blocked_on_.reset();
  return !answers;
}

void BondManager::change_all(Phase phase, std::initializer_list<Transition> transitions) {
  phase_ = phase;
  for (const Transition each : transitions) {
    for (std::size_t s = 0; s < servers_.count; ++s)
      changes_.push_back({phase == Phase::kStarting ? s : servers_.count - 1 - s, each});
  }
}

void BondManager::serve_request() {
  const std::uint8_t command = requests_.front().first;
  answer_ = std::move(requests_.front().second);
  requests_.pop_front();
  if (command == 0) return start_up();
  if (command == 1) return change_all(Phase::kStopping, {Transition::kDeactivate});
  if (command == 2) return change_all(Phase::kStarting, {Transition::kActivate});
  if (command == 3)
    return change_all(Phase::kStopping, {Transition::kDeactivate, Transition::kCleanup});
  std::exchange(answer_, nullptr)(false);
}

void BondManager::step(Time now) {
  if (now < due_ || is_blocked()) return;
  if (!changes_.empty()) return advance(now);
  due_ = later(now, kLooks);
  if (phase_ == Phase::kWaiting && are_all_there()) return start_up();
  if (phase_ == Phase::kRespawning && are_all_there()) return start_up();
  if (phase_ == Phase::kRespawning && now > until_) phase_ = Phase::kIdle;
  const bool listens = phase_ == Phase::kActive || phase_ == Phase::kIdle;
  if (listens && !requests_.empty()) return serve_request();
  const auto is_broken = [now](Time heard) { return later(heard, kBondTimeout) < now; };
  if (phase_ == Phase::kActive && has_bonds_ && std::ranges::any_of(heard_, is_broken))
    change_all(Phase::kResetting, {Transition::kDeactivate, Transition::kCleanup});
}

// The first change is answered now, if the server is there to answer.
void BondManager::advance(Time now) {
  const Change change = changes_.front();
  due_ = later(now, servers_.answer_time());
  switch (servers_.reach(change.server)) {
    case Reach::kBlocks:
      blocked_on_ = servers_.pid(change.server);
      return;
    case Reach::kNobody:
      // A start-up waits for the server; all else ends.
      if (phase_ != Phase::kStarting) finish(false, now);
      return;
    case Reach::kAnswers:
      break;
  }
  const bool agrees = servers_.change(change.server, change.transition);
  changes_.pop_front();
  if (!agrees && phase_ == Phase::kStarting) return finish(false, now);
  if (changes_.empty()) finish(true, now);
}

void BondManager::finish(bool is_done, Time now) {
  changes_.clear();
  if (phase_ == Phase::kResetting) {
    phase_ = Phase::kRespawning;
    until_ = later(now, kRespawn);
    return;
  }
  phase_ = is_done && phase_ == Phase::kStarting ? Phase::kActive : Phase::kIdle;
  std::ranges::fill(heard_, now);
  if (answer_) std::exchange(answer_, nullptr)(is_done);
}

}  // namespace culprit::rover
