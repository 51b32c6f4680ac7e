#include "managers/bt_manager.h"

#include <algorithm>

#include "exemplars/suave/model/visibility.h"

namespace culprit::study {
namespace {

namespace modes = suave::model::modes;

constexpr Duration kPause = std::chrono::milliseconds(100);
constexpr Duration kAction = std::chrono::milliseconds(50);

}  // namespace

BtManager::BtManager(const Setting& setting) : SuaveManager(setting) { run(live()); }

Routine BtManager::live() {
  while (!is_true("guided")) co_await news();
  for (;;) {
    has_failed_ = false;
    co_await tick();
    co_await sleep(kPause);
  }
}

Routine BtManager::tick() {
  co_await ground("motion", is_thruster_failed() ? modes::kRecover : modes::kAllThrusters);
  if (has_failed()) co_return;
  if (is_recharging_ || !is_charged()) {
    co_await recharge();
  } else if (!is_true("detected")) {
    co_await search();
  } else {
    co_await inspect();
  }
}

// Unknown values count as fine.
bool BtManager::is_charged() const {
  return !has_battery() ||
         static_cast<float>(number("battery", 1)) >= static_cast<float>(kLowBattery);
}

Routine BtManager::search() {
  const auto visibility = static_cast<float>(number("visibility", 100));
  const auto& all = suave::model::kSearchModes;
  const auto best = std::find_if(all.begin(), all.end(), [&](const auto& mode) {
    return visibility >= static_cast<float>(mode.visibility);
  });
  if (best != all.end()) co_await ground("search", best->name);
  co_await sleep(kAction);
}

Routine BtManager::inspect() {
  co_await ground("search", modes::kOff);
  if (has_failed()) co_return;
  co_await ground("follow", modes::kFollow);
  co_await sleep(kAction);
}

Routine BtManager::recharge() {
  if (!is_recharging_) {
    co_await ground("search", modes::kOff);
    if (has_failed()) co_return;
    co_await ground("follow", modes::kOff);
    if (has_failed()) co_return;
    has_recharged_ = false;
    co_await ground("recharge", modes::kRecharge);
    if (has_failed()) co_return;
    is_recharging_ = true;
  }
  co_await sleep(kAction);
  if (!has_recharged_) co_return;
  co_await ground("recharge", modes::kNoRecharge);
  is_recharging_ = has_failed();
}

Routine BtManager::ground(std::string system, std::string mode) {
  if (blackboard_[system] == mode) co_return;
  const Request read = ReadMode{};
  const Reply present = co_await ask(system, read, kServiceTimeout);
  bool is_done = present.outcome == Outcome::kDone;
  const auto* value = std::get_if<Value>(&present.value);
  const bool is_there = value != nullptr && *value == Value(mode);
  if (is_done && !is_there) co_await change_mode(system, mode, &is_done);
  if (is_done) blackboard_[system] = mode;
  has_failed_ = !is_done;
}

void BtManager::on_signal(const std::string& name, const Value& value) {
  SuaveManager::on_signal(name, value);
  if (name == "recharged") has_recharged_ = true;
}

}  // namespace culprit::study
