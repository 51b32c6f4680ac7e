// A third implementation, in TypeScript: npm's @foxglove/rtps. Skipped unless `npm ci` was run in
// peers/foxglove.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "ros2/live_test.h"
#include "ros2/peer_process.h"

namespace culprit::ros2 {
namespace {

// The publisher has a process of its own: from the second participant of a process on, Fast DDS 2.9
// announces itself with stray inline QoS, which this peer does not read.
TEST(PeerFoxglove, ReadsOurDiagnostics) {
  const std::filesystem::path directory = CULPRIT_PEER_FOXGLOVE;
  if (!std::filesystem::exists(directory / "node_modules"))
    GTEST_SKIP() << "npm ci was not run in " << directory;
  const TestDomain domain;
  PeerProcess robot({CULPRIT_PEER_NODE, std::to_string(domain.number()), "/peer"});
  PeerProcess foxglove(
      {"node", (directory / "subscriber.mjs").string(), std::to_string(domain.number())});
  EXPECT_TRUE(foxglove.says("status 0 peer: state ticks=0"));
}

}  // namespace
}  // namespace culprit::ros2
