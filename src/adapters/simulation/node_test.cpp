#include "simulation/node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulation/fault.h"
#include "simulation/topic.h"

namespace culprit::simulation {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

// Receives messages, each taking `cost`.
class Listener : public Node {
 public:
  Listener(World& world, Topic<int>& topic, Duration cost, NodeTraits traits = {})
      : Node(world, "/listener", traits), subscription_(*this, topic, [this, cost](int number) {
          occupy(cost);
          heard.push_back(number);
          at.push_back(this->world().now().time_since_epoch() / 1ms);
        }) {
    declare("gain", 1.0);
  }
  std::vector<int> heard;
  std::vector<std::int64_t> at;  // milliseconds

 private:
  Subscription<int> subscription_;
};

class Speaker : public Node {
 public:
  Speaker(World& world, Topic<int>& topic) : Node(world, "/speaker", {}), out_(*this, topic) {}
  void say(int number) { out_.publish(number); }
  void say_after(Duration thinking, int number) {
    post([this, thinking, number] {
      occupy(thinking);
      say(number);
    });
  }

 private:
  Publisher<int> out_;
};

struct Talk {
  explicit Talk(Duration cost = 0ms, Transport transport = {}, NodeTraits traits = {})
      : topic(world, "/numbers", transport),
        speaker(world, topic),
        listener(world, topic, cost, traits) {
    speaker.launch();
    listener.launch();
    run_for(0ms);
  }
  void run_for(Duration time) { world.run(later(world.now(), time)); }

  World world{1};
  Topic<int> topic;
  Speaker speaker;
  Listener listener;
};

TEST(Node, ComesUpAsItsTraitsSay) {
  NodeTraits traits;
  traits.start = {100ms, {}};
  traits.configure = 20ms;
  traits.activation_delay = 50ms;
  Talk talk(0ms, {}, traits);
  EXPECT_EQ(talk.listener.process(), ProcessState::kRunning);
  EXPECT_FALSE(talk.listener.is_in_graph());
  talk.run_for(100ms);
  EXPECT_EQ(talk.listener.lifecycle(), Lifecycle::kInactive);
  talk.run_for(69ms);
  EXPECT_EQ(talk.listener.lifecycle(), Lifecycle::kInactive);
  talk.run_for(1ms);
  EXPECT_EQ(talk.listener.lifecycle(), Lifecycle::kActive);
}

TEST(Node, DoesOneThingAfterTheOther) {
  Talk talk(30ms);
  for (int i = 0; i < 3; ++i) talk.speaker.say(i);
  talk.run_for(100ms);
  EXPECT_THAT(talk.listener.heard, ElementsAre(0, 1, 2));
  EXPECT_THAT(talk.listener.at, ElementsAre(0, 30, 60));
}

TEST(Node, PublishesWhenTheCallbackIsOver) {
  Talk talk;
  talk.speaker.say_after(40ms, 7);
  talk.run_for(100ms);
  EXPECT_THAT(talk.listener.at, ElementsAre(40));
}

TEST(Node, KeepsTheLastTenMessagesThatItHasNoTimeFor) {
  Talk talk(1s);
  for (int i = 0; i < 15; ++i) talk.speaker.say(i);
  talk.run_for(20s);
  EXPECT_THAT(talk.listener.heard, ElementsAre(0, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14));
}

TEST(Node, HearsAndSaysNothingWhileItIsInactive) {
  Talk talk;
  ASSERT_TRUE(talk.listener.change(Transition::kDeactivate));
  talk.speaker.say(1);
  talk.run_for(1s);
  ASSERT_TRUE(talk.listener.change(Transition::kActivate));
  ASSERT_TRUE(talk.speaker.change(Transition::kDeactivate));
  talk.speaker.say(2);
  talk.run_for(1s);
  EXPECT_TRUE(talk.listener.heard.empty());
  EXPECT_FALSE(talk.listener.change(Transition::kActivate));  // it is
}

TEST(Node, AStoppedProcessGoesOnWhereItWas) {
  Talk talk;
  talk.listener.stop();
  talk.speaker.say(1);
  talk.run_for(5s);
  EXPECT_TRUE(talk.listener.heard.empty());
  talk.listener.resume();
  EXPECT_THAT(talk.listener.heard, ElementsAre(1));
}

TEST(Node, AKilledProcessForgetsAndLeavesTheGraphAfterItsLease) {
  Talk talk(1s);
  talk.speaker.say(1);
  talk.speaker.say(2);
  talk.run_for(0ms);
  talk.listener.kill();
  EXPECT_EQ(talk.listener.process(), ProcessState::kGone);
  EXPECT_TRUE(talk.listener.is_in_graph());
  talk.run_for(Node::kLease);
  EXPECT_FALSE(talk.listener.is_in_graph());
  talk.listener.launch();
  talk.run_for(10s);
  EXPECT_THAT(talk.listener.heard, ElementsAre(1));
}

TEST(Node, AHungProcessIsWellAgainAfterItsEnd) {
  Talk talk;
  talk.listener.hang();
  talk.speaker.say(1);
  talk.run_for(1s);
  EXPECT_TRUE(talk.listener.heard.empty());
  bool is_gone = false;
  talk.listener.terminate([&] { is_gone = true; });
  talk.run_for(1s);
  ASSERT_TRUE(is_gone);
  talk.listener.launch();
  talk.run_for(1s);
  talk.speaker.say(2);
  talk.run_for(1s);
  EXPECT_THAT(talk.listener.heard, ElementsAre(2));
}

TEST(Node, ParametersHaveTypesAndAreAsNewInANewProcess) {
  Talk talk;
  EXPECT_TRUE(talk.listener.set_parameter("gain", 2.0));
  EXPECT_FALSE(talk.listener.set_parameter("gain", true));
  EXPECT_FALSE(talk.listener.set_parameter("pain", 2.0));
  EXPECT_EQ(*talk.listener.parameter("gain"), Value(2.0));
  talk.listener.terminate([] {});
  talk.run_for(1s);
  talk.listener.launch();
  talk.run_for(1s);
  EXPECT_EQ(*talk.listener.parameter("gain"), Value(1.0));
}

TEST(Topic, LosesWhatItsTransportSays) {
  Talk talk(0ms, {{1ms, {}}, 0.25});
  for (int i = 0; i < 10'000; ++i) {
    talk.speaker.say(i);
    talk.run_for(1ms);
  }
  EXPECT_NEAR(static_cast<double>(talk.listener.heard.size()), 7500, 200);
}

TEST(Topic, JitterDelaysAndNeverOvertakes) {
  Talk talk(0ms, {{5ms, 50ms}, 0});
  for (int i = 0; i < 100; ++i) {
    talk.speaker.say(i);
    talk.run_for(1ms);
  }
  talk.run_for(1s);
  ASSERT_EQ(talk.listener.heard.size(), 100);
  EXPECT_TRUE(std::is_sorted(talk.listener.heard.begin(), talk.listener.heard.end()));
  EXPECT_GE(talk.listener.at.front(), 5);
}

TEST(Fault, StrikesWhenItIsTime) {
  Talk talk;
  ASSERT_TRUE(inject(talk.world, {Time{10ms}, "/listener", BadParameter{"gain", 9.0}}));
  ASSERT_TRUE(inject(talk.world, {Time{20ms}, "/speaker", Killed{1}}));
  ASSERT_TRUE(inject(talk.world, {Time{30ms}, "", Impaired{"/numbers", {{1s, {}}, 0}}}));
  talk.run_for(9ms);
  EXPECT_EQ(*talk.listener.parameter("gain"), Value(1.0));
  talk.run_for(30ms);
  EXPECT_EQ(*talk.listener.parameter("gain"), Value(9.0));
  EXPECT_EQ(talk.speaker.process(), ProcessState::kGone);
  EXPECT_EQ(talk.topic.transport().latency.least, 1s);
  talk.speaker.launch();  // the first start fails
  talk.run_for(1s);
  EXPECT_EQ(talk.speaker.process(), ProcessState::kGone);
}

TEST(Fault, NeedsSomethingToStrike) {
  Talk talk;
  EXPECT_EQ(inject(talk.world, {{}, "/nobody", Hung{}}).error(), "the robot has no node /nobody");
  EXPECT_EQ(inject(talk.world, {{}, "/listener", BadParameter{"pain", 1.0}}).error(),
            "/listener has no parameter pain");
  EXPECT_EQ(inject(talk.world, {{}, "", Impaired{"/letters", {}}}).error(),
            "the robot has no topic /letters");
}

}  // namespace
}  // namespace culprit::simulation
