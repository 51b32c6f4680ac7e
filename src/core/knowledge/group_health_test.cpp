#include "knowledge/group_health.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;
using enum Lifecycle;

constexpr Time kLongBefore{};
constexpr Time kNow{60s};

class Servers {
 public:
  Servers()
      : rules_(*check(Source("group.rules",
                             "COMPONENT a\nCOMPONENT b\nCOMPONENT m\nGROUP g { a, b } MANAGER m\n"
                             "RULE R\n  POLICIES ERROR REPORT\n  TRIGGER g == \"half_up\"\n"))
                    .rules),
        states_(rules_) {}

  Servers& put(std::size_t member, Lifecycle state, Time since = kLongBefore) {
    ComponentState& all = states_[ComponentId(member)];
    all.alive = true;
    all.alive_since = kLongBefore;
    all.lifecycle = state;
    all.lifecycle_since = since;
    return *this;
  }
  Servers& kill(std::size_t member, Time at = kLongBefore) {
    states_[ComponentId(member)].alive = false;
    states_[ComponentId(member)].alive_since = at;
    return *this;
  }
  ComponentState& operator[](std::size_t member) { return states_[ComponentId(member)]; }
  GroupHealth health(Time now = kNow) const {
    return health_of(rules_.groups.front(), states_, now);
  }
  Time settles(Time now = kNow) const { return settles_at(rules_.groups.front(), states_, now); }

 private:
  RuleSet rules_;
  ComponentStates states_;
};

TEST(GroupHealth, IsUnknownUntilEachMemberIsKnown) {
  EXPECT_EQ(Servers().health(), GroupHealth::kUnknown);
  EXPECT_EQ(Servers().put(0, kActive).health(), GroupHealth::kUnknown);
  EXPECT_EQ(Servers().put(0, kActive).put(1, Lifecycle::kUnknown).health(), GroupHealth::kUnknown);
}

TEST(GroupHealth, FollowsFromItsMembers) {
  EXPECT_EQ(Servers().put(0, kActive).put(1, kActive).health(), GroupHealth::kActive);
  EXPECT_EQ(Servers().put(0, kInactive).put(1, kInactive).health(), GroupHealth::kInactive);
  EXPECT_EQ(Servers().put(0, kUnconfigured).put(1, kUnconfigured).health(), GroupHealth::kDown);
  EXPECT_EQ(Servers().put(0, kUnconfigured).put(1, kActive).kill(1).health(), GroupHealth::kDown);
  EXPECT_EQ(Servers().put(0, kActive).put(1, kInactive).health(), GroupHealth::kHalfUp);
  EXPECT_EQ(Servers().put(0, kInactive).put(1, kUnconfigured).health(), GroupHealth::kHalfUp);
  EXPECT_EQ(Servers().put(0, kActive).put(1, kActive).kill(1).health(), GroupHealth::kHalfUp);
}

TEST(GroupHealth, ChangesWhileAMemberIsInATransitionThatDoesNotHang) {
  Servers servers;
  servers.put(0, kActive).put(1, kTransition)[1].changes_until = kNow + 3s;
  EXPECT_EQ(servers.health(), GroupHealth::kChanging);
  EXPECT_EQ(servers.settles(), kNow + 3s);
  EXPECT_EQ(servers.health(kNow + 3s), GroupHealth::kHalfUp);
}

TEST(GroupHealth, ChangesForAWhileAfterTheLastChange) {
  Servers servers;
  servers.put(0, kActive).put(1, kInactive, kNow - 1s);
  EXPECT_EQ(servers.health(), GroupHealth::kChanging);
  EXPECT_EQ(servers.settles(), kNow - 1s + kGroupSettles);
  EXPECT_EQ(servers.health(servers.settles()), GroupHealth::kHalfUp);
  EXPECT_EQ(Servers().put(0, kActive).put(1, kActive).kill(1, kNow - 1s).health(),
            GroupHealth::kChanging);
}

TEST(GroupHealth, IsActiveAtOnce) {
  EXPECT_EQ(Servers().put(0, kActive).put(1, kActive, kNow).health(), GroupHealth::kActive);
}

}  // namespace
}  // namespace culprit
