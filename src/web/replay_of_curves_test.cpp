#include "web/replay_of_curves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::web {
namespace {

TEST(ReplayOfCurves, TakesNoNameForAnOption) {
  EXPECT_THAT(replay_of_curves("/bin/culprit", "/j.db", 60, -1e300,
                               {"rate /scan", "--rules=/etc/passwd", "-h", "--"}),
              testing::ElementsAre("/bin/culprit", "replay", "/j.db", "--json", "--since",
                                   "60000ms", "--until", "0ms", "--curve=rate /scan",
                                   "--curve=--rules=/etc/passwd", "--curve=-h", "--curve=--"));
}

}  // namespace
}  // namespace culprit::web
