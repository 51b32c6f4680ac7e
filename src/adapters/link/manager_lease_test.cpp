#include "link/manager_lease.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::link {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

constexpr Time kNow{1h};

constexpr const char* kKey = "a key that only friends have";

// The writer of a participant.
rtps::Guid writer(std::uint8_t participant) {
  rtps::Guid guid;
  guid.bytes[0] = participant;
  guid.bytes[15] = 3;
  return guid;
}

rtps::EndpointInfo says(std::uint8_t participant, const std::string& user_data) {
  return {.guid = writer(participant),
          .topic = ManagerLease::kTopic,
          .type = ManagerLease::kType,
          .user_data = user_data,
          .qos = {}};
}
rtps::EndpointInfo claim(std::uint8_t participant, LeaseClaim what) {
  if (what.key.empty()) what.key = kKey;
  const ManagerLease lease(what, writer(participant).prefix());
  return says(participant, lease.announcements().front());
}

ManagerLease lease_of(std::int64_t since, std::int64_t id = 5,
                      std::vector<std::string> nodes = {"/camera", "*/lidar"}) {
  return ManagerLease({"drone", since, id, std::move(nodes), kKey}, writer(200).prefix());
}

TEST(ManagerLease, IsOfTheOneThatBeganFirst) {
  ManagerLease lease = lease_of(100);
  EXPECT_FALSE(lease.elder(kNow));
  lease.apply(claim(1, {"drone", 101, 1}), kNow);
  EXPECT_FALSE(lease.elder(kNow));
  lease.apply(claim(9, {"drone", 99, 1}), kNow);
  EXPECT_EQ(lease.elder(kNow), writer(9).prefix());
  EXPECT_THAT(lease.strangers(), IsEmpty());
}

TEST(ManagerLease, IsOfTheLowerIdIfTwoBeganAtOnce) {
  ManagerLease lower = lease_of(100, 1);
  ManagerLease higher = lease_of(100, 2);
  lower.apply(claim(2, {"drone", 100, 2}), kNow);
  higher.apply(claim(1, {"drone", 100, 1}), kNow);
  EXPECT_FALSE(lower.elder(kNow));
  EXPECT_TRUE(higher.elder(kNow));
}

TEST(ManagerLease, IsNotLostToOneself) {
  ManagerLease lease = lease_of(100, 7);
  lease.apply(claim(3, {"drone", 100, 7}), kNow);
  EXPECT_FALSE(lease.elder(kNow));
  EXPECT_THAT(lease.strangers(), IsEmpty());
}

TEST(ManagerLease, PassesOnWhenTheElderIsGone) {
  ManagerLease lease = lease_of(100);
  lease.apply(claim(1, {"drone", 98, 1}), kNow);
  lease.apply(claim(2, {"drone", 99, 1}), kNow);
  lease.apply(rtps::EndpointGone{writer(1)}, kNow);
  EXPECT_EQ(lease.elder(kNow), writer(2).prefix());
  rtps::Guid participant = writer(2);
  participant.bytes[15] = 0xc1;
  lease.apply(ros2::ParticipantGone{participant}, kNow);
  EXPECT_FALSE(lease.elder(kNow));
}

TEST(ManagerLease, IsOfOneRobotOnlyAndIgnoresNonsense) {
  ManagerLease lease = lease_of(100);
  lease.apply(claim(1, {"rover", 1, 1}), kNow);
  lease.apply(says(2, "robot=drone;since=early;id=1;term=0;"), kNow);
  lease.apply(says(3, "robot=drone;since=1x;id=1;term=0;"), kNow);
  lease.apply(says(4, ""), kNow);
  rtps::EndpointInfo other = claim(6, {"drone", 1, 1});
  other.topic = "rt/chatter";
  lease.apply(other, kNow);
  EXPECT_FALSE(lease.elder(kNow));
  EXPECT_THAT(lease.strangers(), IsEmpty());
}

TEST(ManagerLease, IsNotLostToAStranger) {
  ManagerLease lease = lease_of(100);
  lease.apply(claim(1, {.robot = "drone", .since = 1, .id = 1, .key = "guessed key of a stranger"}),
              kNow);
  lease.apply(says(2, "robot=drone;since=1;id=2;term=0;nodes=;"), kNow);
  lease.apply(says(3, "robot=drone;since=1;id=3;term=0;nodes=;proof=00;"), kNow);
  // Repeats a friend's claim.
  lease.apply(says(4, claim(9, {"drone", 1, 1}).user_data), kNow);
  EXPECT_FALSE(lease.elder(kNow));
  EXPECT_EQ(lease.strangers().size(), 4u);
  EXPECT_EQ(lease.strangers([](const rtps::GuidPrefix& p) { return p.bytes[0] != 2; }).size(), 1u);
}

TEST(ManagerLease, IsNotTakenFromTheElderByABorrowerOfItsName) {
  ManagerLease lease = lease_of(100);
  lease.apply(claim(1, {"drone", 99, 1}), kNow);
  lease.apply(claim(1, {"drone", 300, 9, {}, "another key"}), kNow);
  EXPECT_EQ(lease.elder(kNow), writer(1).prefix());
  EXPECT_THAT(lease.strangers(), IsEmpty());
}

TEST(ManagerLease, WithoutAKeyEverybodyIsAStranger) {
  ManagerLease lease({"drone", 100, 5, {}, ""}, writer(200).prefix());
  lease.apply(claim(1, {"drone", 1, 1}), kNow);
  lease.apply(says(2, "robot=drone;since=1;id=2;term=0;nodes=;proof=;"), kNow);
  EXPECT_FALSE(lease.elder(kNow));
  EXPECT_EQ(lease.strangers().size(), 2u);
}

TEST(ManagerLease, OfANodeIsOfTheOneThatBeganFirstWhateverItsRobotIsCalled) {
  ManagerLease lease = lease_of(100);
  lease.apply(claim(1, {"rover", 99, 1, {"/camera", "/arm"}}), kNow);
  lease.apply(claim(2, {"boat", 98, 1, {"/deck/lidar"}}), kNow);
  lease.apply(claim(3, {"plane", 101, 1, {"/camera"}}), kNow);
  EXPECT_FALSE(lease.elder(kNow));
  EXPECT_EQ(lease.elder_at("/camera", kNow), writer(1).prefix());
  EXPECT_EQ(lease.elder_at("/deck/lidar", kNow), writer(2).prefix());
  EXPECT_FALSE(lease.elder_at("/stern/lidar", kNow));
  EXPECT_FALSE(lease.elder_at("/wheel", kNow));
  EXPECT_FALSE(
      lease.elder_at("/camera", kNow, [](const rtps::GuidPrefix& p) { return p.bytes[0] == 1; }));
}

TEST(ManagerLease, NamesEveryNodeOfARobotHoweverMany) {
  std::vector<std::string> nodes;
  for (int i = 0; i < 60; ++i)
    nodes.push_back("/a/namespace/of/some/length/node_" + std::to_string(i));
  const LeaseClaim many{"fleet", 1, 1, nodes, kKey};
  ManagerLease lease = lease_of(100, 5, nodes);
  const auto said = ManagerLease(many, writer(1).prefix()).announcements();
  EXPECT_GT(said.size(), 1u);
  for (std::size_t i = 0; i < said.size(); ++i) {
    EXPECT_LT(said[i].size(), 1024u);
    rtps::EndpointInfo info = says(1, said[i]);
    info.guid.bytes[14] = static_cast<std::uint8_t>(i);
    lease.apply(info, kNow);
  }
  for (const std::string& node : nodes) EXPECT_TRUE(lease.elder_at(node, kNow)) << node;
}

// Two culprits of one robot on two machines, and the network between them, in virtual time.
struct Machine {
  Machine(std::uint8_t participant, std::int64_t since, std::int64_t term = 0)
      : prefix(writer(participant).prefix()),
        claim{"drone", since, since, {}, kKey, term},
        lease(claim, prefix) {}

  rtps::EndpointInfo announcement() const {
    return says(prefix.bytes[0], lease.announcements().front());
  }
  void ticks(Time now, Machine* other) {
    const auto beat = lease.beat(now, hears, manages, orders);
    if (beat && other != nullptr && other->hears) other->lease.hear(prefix, *beat, now);
  }

  rtps::GuidPrefix prefix;
  LeaseClaim claim;
  ManagerLease lease;
  bool hears = true;
  bool manages = true;
  std::string orders = "none";
};

struct TwoMachines : testing::Test {
  TwoMachines() {
    second.manages = false;
    first.lease.apply(second.announcement(), now);
    second.lease.apply(first.announcement(), now);
  }
  // Both, as far as they run, each on its own time.
  void pass(Duration time, bool first_runs = true, bool second_runs = true) {
    for (const Time end = now + time; now < end; now += ManagerLease::kPeriod) {
      if (first_runs) first.ticks(now, &second);
      if (second_runs) second.ticks(now, &first);
    }
  }
  bool is_led_by_first() const { return second.lease.elder(now).has_value(); }
  bool is_sure() const { return first.lease.sure_until(now) > now; }

  Time now = kNow;
  Machine first{1, 100};
  Machine second{2, 200};
};

TEST_F(TwoMachines, TakeOverWithinTwoSecondsWhenTheManagerDies) {
  pass(20s);
  EXPECT_TRUE(is_led_by_first());
  pass(1s, false);
  EXPECT_TRUE(is_led_by_first());
  pass(1s, false);
  EXPECT_FALSE(is_led_by_first());
}

TEST_F(TwoMachines, DoNotTakeOverFromAManagerWithoutABeatUntilItHadTheTimeForOne) {
  pass(1s, false);
  EXPECT_TRUE(is_led_by_first());
  pass(1s, false);
  EXPECT_FALSE(is_led_by_first());
  EXPECT_FALSE(second.lease.told_orders());
}

TEST_F(TwoMachines, LearnWhatWasOrderedOfTheManager) {
  first.orders = "pause";
  second.orders = "nobody asks the one that advises";
  pass(1s);
  EXPECT_EQ(second.lease.told_orders(), "pause");
  EXPECT_FALSE(first.lease.told_orders());
  first.orders = "resume";
  pass(1s);
  pass(5s, false);
  EXPECT_EQ(second.lease.told_orders(), "resume");
}

TEST_F(TwoMachines, SayThatTheyDoNotSayWhatIsTooLong) {
  first.orders = std::string(100'000, 'x');
  pass(1s);
  EXPECT_EQ(second.lease.told_orders(), "");
}

TEST_F(TwoMachines, DoNotTakeOverWhileTheyCannotHearOrWereAsleep) {
  pass(5s);
  second.hears = false;
  pass(10s);
  EXPECT_TRUE(is_led_by_first());
  second.hears = true;
  pass(1s, false);
  EXPECT_TRUE(is_led_by_first()) << "it has only just begun to listen";
  pass(5s);
  pass(10s, false, false);
  EXPECT_TRUE(is_led_by_first()) << "asleep, before it is asked for a beat";
  second.ticks(now, &first);
  EXPECT_TRUE(is_led_by_first()) << "just woken";
}

TEST_F(TwoMachines, StandStillWhenTheyWereAwayUntilTheyKnowTheManager) {
  pass(5s);
  EXPECT_TRUE(is_sure());
  pass(500ms, false);
  EXPECT_TRUE(is_sure());
  pass(3s, false);
  EXPECT_FALSE(is_sure()) << "before its first beat";
  // The other one took over meanwhile, as another participant.
  Machine successor{3, 200, second.lease.highest_term() + 1};
  first.ticks(now, &second);
  EXPECT_LT(first.lease.sure_until(now), now - 1s) << "the caller may have read its clock before";
  first.lease.apply(successor.announcement(), now);
  successor.ticks(now, &first);
  EXPECT_EQ(first.lease.elder(now), successor.prefix);
  successor.lease.apply(first.announcement(), now);
  first.ticks(now, &successor);
  EXPECT_FALSE(successor.lease.elder(now)) << "a slow culprit is no reason to step back";
  EXPECT_EQ(successor.lease.told_orders(), "none");
}

TEST_F(TwoMachines, GoOnWhenTheyWereAwayAndNobodyTookOver) {
  pass(5s);
  pass(3s, false, false);
  first.ticks(now, &second);
  EXPECT_FALSE(is_sure());
  pass(ManagerLease::kListen + 500ms);
  EXPECT_TRUE(is_sure());
}

TEST_F(TwoMachines, GiveUpTheLeaseWhenTheyAreDeaf) {
  pass(5s);
  first.hears = false;
  pass(2s);
  EXPECT_FALSE(is_led_by_first());
  EXPECT_FALSE(is_sure());
}

TEST_F(TwoMachines, TakeOverAsTheSameParticipantAndGoBeforeTheOneThatWasSlow) {
  first.orders = "pause";
  pass(5s);
  pass(2s, false);
  ASSERT_FALSE(is_led_by_first());
  second.lease.take_over(second.lease.highest_term() + 1);
  second.manages = true;
  EXPECT_FALSE(second.lease.told_orders()) << "the orders to the exited one are in force by now";
  // Its new claim is added to the one that it had.
  rtps::EndpointInfo anew = second.announcement();
  anew.guid.bytes[14] = 7;
  first.lease.apply(anew, now);
  pass(1s);
  EXPECT_EQ(first.lease.elder(now), second.prefix);
  EXPECT_FALSE(second.lease.elder(now));
  EXPECT_GT(second.lease.sure_until(now), now);
}

// A third one that only waits, too.
TEST_F(TwoMachines, OfSeveralThatWaitOneTakesOver) {
  Machine third{3, 300};
  third.manages = false;
  for (Machine* each : {&first, &second}) {
    each->lease.apply(third.announcement(), now);
    third.lease.apply(each->announcement(), now);
  }
  for (const Time end = now + 10s; now < end; now += ManagerLease::kPeriod) {
    const bool is_dead = now > end - 5s;
    if (!is_dead) first.ticks(now, &second);
    if (!is_dead) first.ticks(now, &third);
    second.ticks(now, &third);
    third.ticks(now, &second);
  }
  EXPECT_FALSE(second.lease.elder(now));
  EXPECT_EQ(third.lease.elder(now), second.prefix);
}

TEST_F(TwoMachines, LearnWhatASuccessorHasToKnowHoweverLongItIs) {
  std::string state;
  for (int i = 0; state.size() < 3 * ManagerLease::kLongestPart; ++i) state += std::to_string(i);
  first.lease.tell_state(state);
  pass(1s);
  for (const std::string& part : first.lease.state_parts(now)) {
    EXPECT_LT(part.size(), ManagerLease::kLongestBeat);
    second.lease.hear(first.prefix, part, now + 40s);
  }
  ASSERT_TRUE(second.lease.told_state());
  EXPECT_EQ(second.lease.told_state()->text, state);
  EXPECT_EQ(second.lease.told_state()->shift, 40s);
  EXPECT_THAT(first.lease.state_parts(now), IsEmpty()) << "it was told";
  now += ManagerLease::kStatePeriod;
  EXPECT_FALSE(first.lease.state_parts(now).empty()) << "a late joiner must receive it";
  EXPECT_THAT(second.lease.state_parts(now), IsEmpty()) << "it does not manage";
}

TEST_F(TwoMachines, TakeNoPartsOfTwoStatesForOne) {
  pass(1s);
  first.lease.tell_state(std::string(ManagerLease::kLongestPart + 1, 'a'));
  const auto a = first.lease.state_parts(now);
  first.lease.tell_state(std::string(ManagerLease::kLongestPart + 1, 'b'));
  const auto b = first.lease.state_parts(now);
  ASSERT_EQ(a.size(), 2u);
  ASSERT_EQ(b.size(), 2u);
  second.lease.hear(first.prefix, a[0], now);
  second.lease.hear(first.prefix, b[1], now);
  EXPECT_FALSE(second.lease.told_state());
  second.lease.hear(first.prefix, a[1], now);
  EXPECT_FALSE(second.lease.told_state()) << "an old one";
  second.lease.hear(first.prefix, b[0], now);
  ASSERT_TRUE(second.lease.told_state());
  EXPECT_EQ(second.lease.told_state()->text, std::string(ManagerLease::kLongestPart + 1, 'b'));
}

TEST_F(TwoMachines, BelieveNoStateOfAStrangerAndTellNoneThatIsTooLong) {
  pass(1s);
  first.lease.tell_state("the truth");
  const auto parts = first.lease.state_parts(now);
  ASSERT_EQ(parts.size(), 1u);
  std::string forged = parts[0];
  forged.replace(forged.find("truth"), 5, "lies!");
  second.lease.hear(first.prefix, forged, now);
  second.lease.hear(second.prefix, parts[0], now);
  for (const char* nonsense : {"proof=;state=1;", "proof=00;state=1;round=1;part=0;of=1;clock=0;x"})
    second.lease.hear(first.prefix, nonsense, now);
  EXPECT_FALSE(second.lease.told_state());
  // An older culprit takes it for a beat without a proof: it counts as none of a newer one either.
  std::string beat = parts[0];
  beat.replace(beat.find("state=1;"), 8, "count=9;manages=1;");
  second.lease.hear(first.prefix, beat, now);
  EXPECT_FALSE(second.lease.told_state());
  first.lease.tell_state(std::string(ManagerLease::kLongestState + 1, 'x'));
  now += ManagerLease::kStatePeriod;
  EXPECT_THAT(first.lease.state_parts(now), IsEmpty());
}

TEST_F(TwoMachines, BelieveNoBeatOfAStrangerAndNoOldOne) {
  first.orders = "pause";
  const auto old = first.lease.beat(now, true, true, "resume");
  pass(1s);
  second.lease.hear(first.prefix, *old, now);
  EXPECT_EQ(second.lease.told_orders(), "pause");
  std::string forged = *first.lease.beat(now, true, true, "pause");
  forged.replace(forged.find("pause"), 5, "resum");
  second.lease.hear(first.prefix, forged, now);
  EXPECT_EQ(second.lease.told_orders(), "pause");
  LeaseClaim stranger = first.claim;
  stranger.key = "guessed key of a stranger";
  ManagerLease guessing(stranger, first.prefix);
  for (int i = 0; i < 100; ++i)
    second.lease.hear(first.prefix, *guessing.beat(now, true, true, "resume"), now);
  EXPECT_EQ(second.lease.told_orders(), "pause");
  // In another's name.
  second.lease.hear(second.prefix, *first.lease.beat(now, true, true, "resume"), now);
  for (const char* nonsense : {"", "proof=", "proof=;", "proof=00;count=1;manages=1;orders="})
    second.lease.hear(first.prefix, nonsense, now);
  EXPECT_EQ(second.lease.told_orders(), "pause");
}

TEST(ManagerLease, WithoutAKeyNothingIsSaidAndNothingWaitedFor) {
  ManagerLease lease({"drone", 100, 5, {}, ""}, writer(200).prefix());
  EXPECT_FALSE(lease.beat(kNow, true, true, "pause"));
  EXPECT_EQ(lease.sure_until(kNow + 1h), kNever);
}

}  // namespace
}  // namespace culprit::link
