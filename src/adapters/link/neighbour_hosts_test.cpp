#include "link/neighbour_hosts.h"

#include <gtest/gtest.h>

namespace culprit::link {
namespace {

using namespace std::chrono_literals;

rtps::GuidPrefix participant(std::uint8_t number) {
  rtps::GuidPrefix prefix;
  prefix.bytes[0] = number;
  return prefix;
}

// The last datagrams of participants 1 and 2 of rover2 came at 10 s.
struct Domain {
  Domain() {
    joined(1);
    joined(2);
  }
  void joined(std::uint8_t number, const std::string& host = "rover2", bool is_here = false) {
    last[participant(number)] = now;
    hosts.joined(participant(number), host, is_here);
  }
  void hear(std::uint8_t number) { last[participant(number)] = now; }
  void lose(std::uint8_t number) {
    last.erase(participant(number));
    hosts.left(participant(number), true, now);
  }
  bool is_silent(const std::string& host = "rover2") { return hosts.is_silent(host, now); }

  Time now{10s};
  std::map<rtps::GuidPrefix, Time> last;
  NeighbourHosts hosts{[this](const rtps::GuidPrefix& prefix) {
    return last.contains(prefix) ? last.at(prefix) : kLongAgo;
  }};
};

TEST(NeighbourHosts, AreSilentWhenNothingComesFromAnyOfTheirParticipants) {
  Domain domain;
  domain.now += NeighbourHosts::kPatience - 1ns;
  EXPECT_FALSE(domain.is_silent());
  domain.now += 1ns;
  EXPECT_TRUE(domain.is_silent());
  domain.hear(2);
  EXPECT_FALSE(domain.is_silent());
}

TEST(NeighbourHosts, StaySilentWhenTheLeasesRunOut) {
  Domain domain;
  domain.now += 20s;
  domain.lose(1);
  EXPECT_TRUE(domain.is_silent());
  domain.now += 5s;
  domain.lose(2);
  domain.now += 1h;
  EXPECT_TRUE(domain.is_silent());
  domain.joined(3);
  EXPECT_FALSE(domain.is_silent());
}

TEST(NeighbourHosts, AreNotSilentWhereOneParticipantOrNoneIsMissed) {
  Domain domain;
  domain.now += 20s;
  domain.hear(2);
  domain.lose(1);
  EXPECT_FALSE(domain.is_silent()) << "it went by itself";
  domain.now += 1h;
  EXPECT_FALSE(domain.is_silent()) << "it may be that one process";
  EXPECT_FALSE(domain.is_silent("rover3")) << "no datagram came from it";
  EXPECT_FALSE(domain.is_silent(""));
}

TEST(NeighbourHosts, AreNotSilentIfTheirParticipantsSaidGoodBye) {
  Domain domain;
  domain.hosts.left(participant(1), false, domain.now);
  domain.hosts.left(participant(2), false, domain.now);
  domain.now += 1h;
  EXPECT_FALSE(domain.is_silent());
}

TEST(NeighbourHosts, AreNotSilentToOneThatDidNotListen) {
  Domain domain;
  domain.now += 1h;
  domain.hosts.listens_from(domain.now);
  EXPECT_FALSE(domain.is_silent());
  domain.now += NeighbourHosts::kPatience;
  EXPECT_TRUE(domain.is_silent());
}

// A participant on this computer that announces another one's name cannot make that one seem
// reachable.
TEST(NeighbourHosts, HaveNoWitnessOnThisComputer) {
  Domain domain;
  domain.now += 1h;
  domain.joined(3, "rover2", true);
  EXPECT_TRUE(domain.is_silent());
  EXPECT_EQ(domain.hosts.heard("rover2"), Time(10s));
}

TEST(NeighbourHosts, OfOneParticipantAreNoWitnessOfIt) {
  Domain domain;
  domain.joined(7, "rover7");
  EXPECT_EQ(domain.hosts.heard("rover7"), kNever);
  EXPECT_EQ(domain.hosts.heard("rover8"), kNever);
}

TEST(NeighbourHosts, AreBoundedAndMakeRoomOfThoseThatAreGone) {
  Domain domain;
  for (std::size_t i = 0; i < 2 * NeighbourHosts::kMostHosts; ++i) {
    domain.joined(50, "stranger" + std::to_string(i));
    domain.lose(50);
  }
  domain.joined(60, "rover6");
  domain.joined(61, "rover6");
  domain.now += 1h;
  EXPECT_TRUE(domain.is_silent("rover6"));
}

}  // namespace
}  // namespace culprit::link
