#include "rule_test/bag_run.h"

#include "bag/bag_file.h"
#include "bag/bag_reading.h"
#include "base/environment.h"
#include "replay/bag_replay.h"

namespace culprit::rule_test {

Result run_bag_test(const RuleSet& rules, const Test& test,
                    std::unique_ptr<const Planner> planner) {
  Result result{test.name, test.length, {}, {}};
  auto bag = bag::BagFile::open(test.bag);
  if (!bag) {
    result.disappointments.push_back({test.span, bag.error()});
    return result;
  }
  ros2::MessageLibrary library(ros2::message_directories({}, environment("AMENT_PREFIX_PATH")));
  bag::BagReading reading(rules, bag->contents(), library);
  std::optional<Time> begin;
  const auto take = [&](const Event& event, std::int64_t) {
    result.events.push_back(event);
    result.events.back().at = Time(event.at - begin.value_or(event.at));
  };
  replay::BagReplay replay(rules, std::move(planner), reading, {.on_event = take});
  for (bag::BagMessage message; bag->next(message);) {
    const Time now{Duration(message.at)};
    if (!begin) begin = now;
    if (test.length > Duration::zero() && now - *begin > test.length) break;
    replay.step(message);
  }
  if (begin && test.length == Duration::zero()) result.length = replay.end() - *begin;
  return result;
}

std::vector<Event> with_preferred(const std::vector<Event>& events) {
  std::vector<Event> all = events;
  for (Event& event : all) {
    if (const auto* held = std::get_if<ActionHeldBack>(&event.what)) {
      StrategyChosen chosen;
      chosen.strategy = held->strategy;
      event.what = std::move(chosen);
    }
  }
  return all;
}

}  // namespace culprit::rule_test
