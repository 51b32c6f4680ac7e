#include "live/running_elsewhere.h"

#include <gtest/gtest.h>

namespace culprit::live {
namespace {

constexpr ComponentId kCamera{0};

struct Elsewhere : testing::Test {
  template <class What>
  void see(What what) {
    elsewhere.observe({Time{}, std::move(what)});
  }
  std::string host() const { return elsewhere.host_of(kCamera); }

  RunningElsewhere elsewhere{"desk"};
};

// The node that is lost there may go on; one that says good-bye does not (LivesOn without a host).
TEST_F(Elsewhere, ANodeRunsThereUntilItLeftOrIsHere) {
  EXPECT_EQ(host(), "");
  see(LivesOn{kCamera, "rover2"});
  EXPECT_EQ(host(), "rover2");
  see(NodeVanished{"/camera"});
  EXPECT_EQ(host(), "rover2");
  see(LivesOn{kCamera, ""});
  EXPECT_EQ(host(), "");
}

TEST_F(Elsewhere, AnEarlierProcessOfThisComputerIsNotTheOneThere) {
  see(ProcessSeen{kCamera, ProcessState::kRunning, 7, ""});
  see(ProcessSeen{kCamera, ProcessState::kGone, 7, "exit code 0", Cause::kWish});
  see(LivesOn{kCamera, "rover2"});
  EXPECT_EQ(host(), "rover2");
}

// LAUNCH "ssh rover2 ..." ends with the node there.
TEST_F(Elsewhere, WhatWasStartedFromHereEndsHere) {
  see(ProcessSeen{kCamera, ProcessState::kRunning, 7, ""});
  see(LivesOn{kCamera, "rover2"});
  see(ProcessSeen{kCamera, ProcessState::kGone, 7, "exit code 255", Cause::kFault});
  EXPECT_EQ(host(), "");
}

// The process of a node in Python ends after its node has left the graph.
TEST_F(Elsewhere, ANodeThatAPersonMovedRunsThereAlsoOnceItsProcessHereHasEnded) {
  elsewhere.runs_here(kCamera, 7);
  see(ProcessSeen{kCamera, ProcessState::kRunning, 7, ""});
  see(LivesOn{kCamera, "rover2"});
  see(ProcessSeen{kCamera, ProcessState::kGone, 7, "exit code 0", Cause::kWish});
  EXPECT_EQ(host(), "rover2");
  elsewhere.runs_here(kCamera, 8);
  EXPECT_EQ(host(), "");
}

TEST_F(Elsewhere, WhatAnEarlierRunSawCountsUntilThisOneSeesIt) {
  elsewhere.remember(kCamera, "rover2");
  EXPECT_EQ(host(), "rover2");
  elsewhere.runs_here(kCamera, 7);
  elsewhere.remember(kCamera, "rover2");
  EXPECT_EQ(host(), "");
  see(LivesOn{kCamera, "rover3"});
  elsewhere.remember(kCamera, "rover2");
  EXPECT_EQ(host(), "rover3");
}

TEST_F(Elsewhere, ANodeWithAnUnknownProcessOnThisComputerRunsHere) {
  see(LivesOn{kCamera, "desk"});
  EXPECT_EQ(host(), "");
}

}  // namespace
}  // namespace culprit::live
