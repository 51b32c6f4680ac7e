// How far a campaign is, from what it prints.
#include "web/study_runner.h"

#include <gtest/gtest.h>

#include "terminal/progress.h"

namespace culprit::web {
namespace {

using Pair = std::pair<std::uint64_t, std::uint64_t>;

TEST(StudyRunner, ReadsTheNewestProgress) {
  const std::string log = progress_line(10, 1296, 0, std::chrono::seconds(1)) + "\n" +
                          progress_line(454, 1296, 0, std::chrono::seconds(2)) + "\n";
  EXPECT_EQ(last_progress(log), Pair(454, 1296));
}

TEST(StudyRunner, KnowsNoProgressOfACampaignThatTellsNone) {
  for (const char* log : {"", "/", "culprit: no such file", "a/b", "1/", "/1"})
    EXPECT_FALSE(last_progress(log)) << log;
}

}  // namespace
}  // namespace culprit::web
