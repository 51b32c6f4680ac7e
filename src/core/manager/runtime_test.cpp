#include "manager/runtime.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "manager/manager.h"
#include "plan/bayes/bayes_planner.h"

namespace culprit::test {
namespace {

using namespace std::chrono_literals;

// A robot that never sends a message.
class SilentRobot : public Robot {
 public:
  Time now() const override { return now_; }
  void observe(Time until, std::vector<Observation>&) override { now_ = until; }
  void execute(const Command&) override {}

 private:
  Time now_{};
};

TEST(Runtime, StepsWhenSomebodyWantsToLookThoughNothingHappens) {
  const RuleSet no_rules;
  Manager manager(no_rules, std::make_unique<BayesPlanner>(), {});
  SilentRobot robot;
  Runtime runtime(manager, robot);
  std::vector<Time> looks;
  runtime.next_look = [&] { return looks.empty() ? Time(20s) : later(looks.back(), 7s); };
  runtime.on_step = [&](const Runtime::Step& step) {
    if (step.now >= Time(20s)) looks.push_back(step.now);
  };
  const std::atomic<bool> stop = false;
  runtime.run(stop, Time(40s));
  EXPECT_THAT(looks, testing::ElementsAre(Time(20s), Time(27s), Time(34s), Time(40s)));
}

// Asks for something in its second step only.
class AsksOnce : public ManagingSystem {
 public:
  std::vector<Command> step(Time, std::span<const Observation>) override {
    return ++steps_ == 2
               ? std::vector<Command>{{CommandId{1}, ComponentId(0), StartProcess{}, {}, {}}}
               : std::vector<Command>{};
  }
  Time next_deadline() const override { return kNever; }
  std::span<const Event> events() const override { return {}; }

 private:
  int steps_ = 0;
};

TEST(Runtime, SendsWhatWasWrittenDownBeforeItTellsOthers) {
  AsksOnce manager;
  std::vector<std::string> done;
  struct RecordingRobot : SilentRobot {
    explicit RecordingRobot(std::vector<std::string>& sent) : done(sent) {}
    void execute(const Command&) override { done.push_back("send"); }
    std::vector<std::string>& done;
  } robot(done);
  Runtime runtime(manager, robot);
  runtime.before_commands = [&](const Runtime::Step&) { done.push_back("write down"); };
  runtime.on_step = [&](const Runtime::Step&) { done.push_back("tell"); };
  std::vector<Observation> none;
  for (int i = 0; i < 3; ++i) runtime.step(none);
  EXPECT_THAT(done, testing::ElementsAre("tell", "write down", "send", "tell", "tell"));
}

}  // namespace
}  // namespace culprit::test
