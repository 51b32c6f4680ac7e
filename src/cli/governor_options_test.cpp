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
  options.restarts = "3/30m";
  EXPECT_EQ(options.options()->limits.restarts.period, 30min);
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

TEST(GovernorOptions, SayHowAnIntensityIsWritten) {
  const auto error_of = [](const std::string& restarts) {
    GovernorOptions options;
    options.restarts = restarts;
    return options.options() ? "no error" : options.options().error();
  };
  EXPECT_EQ(error_of("20 per hour"), "--restarts: '20 per hour' is no intensity; write 20/1h");
  EXPECT_EQ(error_of("20/h"), "--restarts: '20/h' is no intensity; write 20/1h");
  EXPECT_EQ(error_of("5/m"), "--restarts: '5/m' is no intensity; write 5/1min");
  EXPECT_EQ(error_of("10"), "--restarts: '10' is no intensity; write 10/1min");
  EXPECT_EQ(error_of("unlimited"), "--restarts: 'unlimited' is no intensity; write none");
  EXPECT_EQ(error_of("often"),
            "--restarts: 'often' is no intensity; write for example 5/1min, or none");
  EXPECT_EQ(error_of("20/2days"),
            "--restarts: '20/2days' is no intensity; write for example 5/1min, or none");
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
