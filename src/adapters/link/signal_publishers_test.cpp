#include "link/signal_publishers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::link {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using StatusPublisher = SignalPublishers::Publisher;

const StatusPublisher kDriver{"/driver", true};
const StatusPublisher kRemote{"/driver", false};
const StatusPublisher kStranger{"/stranger", false};

struct Statuses {
  SignalPublishers::Answer says(const StatusPublisher& by, Duration at = 0s) {
    return publishers.judge("motor", by, Time(at),
                            [&](const std::string& node) { return there.contains(node); });
  }
  bool uses(const StatusPublisher& by, Duration at = 0s) { return says(by, at).is_used; }
  std::set<std::string> there = {"/driver", "/stranger"};
  SignalPublishers publishers;
};

TEST(SignalPublishers, AreTheFirstThatSayIt) {
  Statuses statuses;
  const auto first = statuses.says(kDriver);
  EXPECT_TRUE(first.is_used && first.is_learned);
  EXPECT_FALSE(statuses.says(kDriver).is_learned) << "once";
  const auto second = statuses.says(kStranger);
  EXPECT_FALSE(second.is_used);
  EXPECT_THAT(second.conflict, HasSubstr("motor is published by /driver, and by /stranger, too"));
  EXPECT_THAT(statuses.says(kStranger).conflict, "") << "once";
  EXPECT_EQ(statuses.publishers.conflicts().size(), 1u);
  EXPECT_TRUE(statuses.uses(kDriver));
}

TEST(SignalPublishers, MayPublishStatusesOfSeveralAndOfOthers) {
  Statuses statuses;
  const auto is_there = [](const std::string&) { return true; };
  for (const std::string status : {"motor", "camera", "battery"})
    EXPECT_TRUE(statuses.publishers.judge(status, kDriver, Time(), is_there).is_used);
  EXPECT_FALSE(statuses.publishers.judge("camera", {"/camera", true}, Time(), is_there).is_used);
}

// The vehicle reports that a thruster failed, and the controller that it works again.
TEST(SignalPublishers, MayBeBesidesAComponentThatIsProven) {
  Statuses statuses;
  statuses.says(kDriver);
  const auto besides = statuses.says({"/controller", true, true, ComponentId(1)});
  EXPECT_TRUE(besides.is_used);
  EXPECT_EQ(besides.conflict, "");
  EXPECT_TRUE(statuses.uses(kDriver));
  EXPECT_FALSE(statuses.uses({"/controller", false, true, ComponentId(1)}))
      << "somebody in its name";
  EXPECT_FALSE(statuses.uses({"/controller", true, false, ComponentId(1)}))
      << "another node of its name";
}

// After a redeploy it is another process, and the same node.
TEST(SignalPublishers, AreSucceededByTheNextProcessOfTheNode) {
  Statuses statuses;
  statuses.says(kDriver);
  statuses.there.erase("/driver");
  EXPECT_FALSE(statuses.uses(kStranger, 10s)) << "while it is being started again";
  statuses.there.insert("/driver");
  EXPECT_TRUE(statuses.uses(kDriver, 11s));
  EXPECT_FALSE(statuses.uses(kStranger, 300s));
}

TEST(SignalPublishers, ThatWereProvenAreNoStrangersOfTheirName) {
  Statuses statuses;
  EXPECT_FALSE(statuses.uses(kRemote)) << "somebody may be proven in a moment";
  EXPECT_TRUE(statuses.uses(kRemote, 3s)) << "on another computer none is";
  EXPECT_TRUE(statuses.uses(kDriver, 4s));
  const auto forged = statuses.says(kRemote);
  EXPECT_FALSE(forged.is_used);
  EXPECT_THAT(forged.conflict, HasSubstr("another participant that claims this name"));
  EXPECT_FALSE(statuses.uses({"/driver", true, false})) << "not the one that holds the name";
}

TEST(SignalPublishers, GiveWayToOneThatIsProven) {
  Statuses statuses;
  statuses.says(kStranger);
  EXPECT_TRUE(statuses.uses(kStranger, 3s)) << "it came first";
  const auto driver = statuses.says(kDriver);
  EXPECT_TRUE(driver.is_used && driver.is_learned);
  EXPECT_THAT(driver.conflict, HasSubstr("culprit ignores /stranger"));
  EXPECT_FALSE(statuses.uses(kStranger));
}

// As drivers with a number in their name.
TEST(SignalPublishers, AreReplacedByOneOfAnotherNameOnceTheyAreGoneForLong) {
  Statuses statuses;
  statuses.says(kDriver);
  statuses.there.erase("/driver");
  const StatusPublisher next{"/driver_7", true};
  EXPECT_FALSE(statuses.uses(next, 1s));
  EXPECT_FALSE(statuses.uses(next, 30s));
  EXPECT_FALSE(statuses.uses(kStranger, 40s)) << "a stranger never";
  EXPECT_TRUE(statuses.uses(next, 41s));
  EXPECT_FALSE(statuses.uses(kStranger, 42s));
}

TEST(SignalPublishers, OfAnEarlierRunAreKnown) {
  Statuses statuses;
  statuses.publishers.remember("motor", "/driver");
  EXPECT_FALSE(statuses.uses(kStranger, 1s)) << "though it comes first this time";
  EXPECT_TRUE(statuses.uses(kDriver, 2s));
}

TEST(SignalPublishers, AreWaitedForUntilANodeClaimsThem) {
  Statuses statuses;
  EXPECT_FALSE(statuses.uses({"", true}, 1s)) << "it may be the stranger";
  EXPECT_TRUE(statuses.uses(kDriver, 2s));
  Statuses without_node;
  EXPECT_FALSE(without_node.uses({"", true}, 1s));
  EXPECT_TRUE(without_node.uses({"", true}, 4s)) << "not of ROS 2";
}

// A process that was started again speaks a moment before its node is known.
TEST(SignalPublishers, AreNoConflictBeforeANodeCouldClaimThem) {
  Statuses statuses;
  statuses.says(kDriver);
  EXPECT_EQ(statuses.says({"", true, true, {}, true}).conflict, "");
  EXPECT_FALSE(statuses.uses({"", true, true, {}, true}));
  EXPECT_THAT(statuses.says({"", true}).conflict, HasSubstr("a participant without a node"));
}

// SIGNAL … FROM driver
TEST(SignalPublishers, ThatAreDeclaredAreNotLearned) {
  Statuses statuses;
  statuses.publishers.declare("motor", ComponentId(0), "driver");
  const auto stranger = statuses.says(kStranger, 10s);
  EXPECT_FALSE(stranger.is_used) << "though it came first";
  EXPECT_THAT(stranger.conflict, HasSubstr("motor is published by /stranger, but the rules read it "
                                           "FROM driver: culprit ignores /stranger"));
  EXPECT_EQ(statuses.says({"/lidar", true, true, ComponentId(1)}, 10s).conflict, "")
      << "a component may have a status of that name, which no rule reads";
  const StatusPublisher declared{"/driver", true, true, ComponentId(0)};
  const auto driver = statuses.says(declared, 11s);
  EXPECT_TRUE(driver.is_used);
  EXPECT_FALSE(driver.is_learned) << "the rules say it each time";
  EXPECT_FALSE(statuses.uses({"/driver", false, true, ComponentId(0)}, 12s)) << "in its name";
  EXPECT_FALSE(statuses.uses({"/driver", true, false, ComponentId(0)}, 12s));
  statuses.there.erase("/driver");
  EXPECT_FALSE(statuses.uses(kStranger, 300s)) << "though it has left for long";
  EXPECT_FALSE(statuses.uses({"/driver_7", true}, 300s));
  EXPECT_TRUE(statuses.uses(declared, 301s));
}

TEST(SignalPublishers, ThatAreDeclaredMayBeTwoOnOtherComputers) {
  Statuses statuses;
  statuses.publishers.declare("motor", ComponentId(0), "left");
  statuses.publishers.declare("motor", ComponentId(1), "right");
  const StatusPublisher left{"/left", false, true, ComponentId(0)};
  const StatusPublisher right{"/right", false, true, ComponentId(1)};
  statuses.says(left), statuses.says(right);
  EXPECT_TRUE(statuses.uses(left, 3s));
  EXPECT_TRUE(statuses.uses(right, 3s));
  EXPECT_THAT(statuses.says(kStranger).conflict, HasSubstr("FROM left and right"));
}

}  // namespace
}  // namespace culprit::link
