// The switches of the governor, as they are written.
#include "cli/governor_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

TEST(GovernorOptions, BoundTheRestartsOfAComponentUnlessToldNotTo) {
  GovernorOptions options;
  EXPECT_EQ(options.options()->limits.restarts.most, 20);
  EXPECT_EQ(options.options()->limits.restarts.period, 1h);
  options.restarts = "3/30min";
  EXPECT_EQ(options.options()->limits.restarts.most, 3);
  options.restarts = "none";
  EXPECT_EQ(options.options()->limits.restarts.most, 0);
}

TEST(GovernorOptions, KnowNoIntensityThatARestartForgets) {
  GovernorOptions options;
  options.restarts = "20/2h";
  ASSERT_FALSE(options.options());
  EXPECT_THAT(options.options().error(),
              HasSubstr("--restarts: '20/2h' counts for longer than 1h"));
}

TEST(GovernorOptions, OfARunThatKnewNoBoundOfRestartsHaveNone) {
  GovernorOptions options;
  options.restarts = "3/30min";
  EXPECT_EQ(GovernorOptions::from_json(options.to_json()).restarts, "3/30min");
  auto older = options.to_json();
  older.erase("restarts");
  EXPECT_EQ(GovernorOptions::from_json(older).restarts, "none");
}

}  // namespace
}  // namespace culprit::cli
