// The page reads how far a campaign is from what it prints.
#include <gtest/gtest.h>

#include "terminal/progress.h"
#include "web/study_runner.h"

namespace culprit {
namespace {

using web::last_progress;

using Pair = std::pair<std::uint64_t, std::uint64_t>;

TEST(StudyProgress, IsReadAtItsNewest) {
  const std::string log = progress_line(10, 1296, 0, std::chrono::seconds(1)) + "\n" +
                          progress_line(454, 1296, 0, std::chrono::seconds(2)) + "\n";
  EXPECT_EQ(last_progress(log), Pair(454, 1296));
}

TEST(StudyProgress, OfACampaignThatTellsNoneIsUnknown) {
  for (const char* log : {"", "/", "culprit: no such file", "a/b", "1/", "/1"})
    EXPECT_FALSE(last_progress(log)) << log;
}

TEST(StudyProgress, IsNotPartOfWhatWentWrong) {
  const std::string progress = progress_line(10, 20, 0, std::chrono::seconds(1)) + "\n";
  EXPECT_EQ(web::after_progress("warning\n" + progress + progress + "no report\n"), "no report\n");
  for (const char* log : {"", "no such file", "no such file\nat all\n"})
    EXPECT_EQ(web::after_progress(log), log);
  EXPECT_EQ(web::after_progress(progress), "");
}

}  // namespace
}  // namespace culprit
