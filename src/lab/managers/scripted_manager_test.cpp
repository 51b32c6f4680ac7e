#include "managers/scripted_manager.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::study {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

RuleSet names() {
  RuleSet names;
  names.components.push_back({"pump", "/pump", {}, true});
  names.signals.push_back({"heat", LookedUp{}, {}, {}, {}});
  return names;
}

// Two threads that share a gate; what they did, in order.
class Script : public ScriptedManager {
 public:
  explicit Script(const RuleSet& names) : ScriptedManager(names, 1) {
    run(first());
    run(second());
  }
  std::vector<std::string> log;

 private:
  void note(const std::string& what) {
    log.push_back(std::to_string(now().time_since_epoch() / 1ms) + " " + what);
  }
  Routine work(std::string name, Duration time) {
    co_await enter(gate_);
    note(name + " in");
    co_await sleep(time);
    leave(gate_);
    note(name + " out");
  }
  Routine first() {
    co_await sleep(10ms);
    co_await work("first", 20ms);
    const Request request = ChangeMode{"fast"};
    const Reply reply = co_await ask("pump", request, 1s);
    note(reply.outcome == Outcome::kDone ? "done" : "not done");
    ring(bell_);
  }
  Routine second() {
    co_await sleep(15ms);
    co_await work("second", 20ms);
    co_await news();
    note("heat " + std::to_string(number("heat", 0)));
    co_await hear(bell_);
    note("rung");
  }
  Gate gate_;
  Bell bell_;
};

TEST(ScriptedManager, DoesWhatItsThreadsDoInTheirTime) {
  const RuleSet rules = names();
  Script script(rules);
  EXPECT_EQ(script.next_deadline(), kLongAgo);
  const auto step = [&](Duration at, std::vector<Observation> observations = {}) {
    return script.step(Time{at}, observations);
  };
  step(0ms);
  std::vector<Command> commands;
  for (Duration now{}; now <= 60ms;) {
    const auto more = step(now);
    commands.insert(commands.end(), more.begin(), more.end());
    if (script.next_deadline() == kNever) break;
    now = script.next_deadline().time_since_epoch();
  }
  ASSERT_EQ(commands.size(), 1u);
  EXPECT_EQ(to_string(commands[0]), "change mode to fast");
  step(70ms, {{Time{65ms}, SignalRead{SignalId(0), 7.5}}});
  step(80ms, {{Time{80ms}, Reply{{99}, Outcome::kDone, {}, ""}},  // nobody asked
              {Time{80ms}, Reply{commands[0].id, Outcome::kDone, {}, ""}}});
  EXPECT_THAT(script.log, ElementsAre("10 first in", "30 first out", "30 second in",
                                      "50 second out", "65 heat 7.500000", "80 done", "80 rung"));
  EXPECT_EQ(script.next_deadline(), kNever);
}

TEST(ScriptedManager, CanBeGivenUpInTheMiddleOfEverything) {
  const RuleSet rules = names();
  Script script(rules);
  script.step(Time{0ms}, {});
  script.step(Time{20ms}, {});
}

}  // namespace
}  // namespace culprit::study
