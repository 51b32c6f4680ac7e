#include "suave_study/recorded.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::study {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kHead =
    "mission name,datetime,\"initial pos (x,y)\",mission duration (s),pipeline found,"
    "time searching pipeline (s),distance inspected (m),mean reaction time (s)\n";

std::string error_of(const std::string& text) {
  RecordedCampaign campaign;
  const auto added = add_recorded("runs.csv", text, campaign);
  EXPECT_TRUE(campaign.rows.empty()) << "nothing of a damaged file counts";
  return added ? "" : added.error();
}

TEST(Recorded, RunsOfTheExemplarAreReadByManager) {
  RecordedCampaign campaign;
  ASSERT_TRUE(
      add_recorded("a.csv",
                   std::string(kHead) +
                       "suave bt,01-Jan-2026-00-00-00,\"(-17.0, 2.8)\",250,True,100,30.5,0.1\r\n"
                       "suave bt,01-Jan-2026-00-05-00,\"(-17.0, 2.8)\",250,True,110,31.5,0.1\n"
                       "\n"
                       ",,,,AVERAGE,105,31,0.1\n"
                       "suave rosa_bt,01-Jan-2026-00-10-00,\"(-17.0, 2.8)\",251,False,251,0,0\n"
                       "suave mine,01-Jan-2026-00-15-00,\"(-17.0, 2.8)\",250,True,90,33,0",
                   campaign));
  ASSERT_EQ(campaign.rows.size(), 2u);
  EXPECT_EQ(campaign.rows[0].manager, "bt");
  EXPECT_EQ(campaign.rows[0].search_s.mean(), 105);
  EXPECT_EQ(campaign.rows[0].distance_m.mean(), 31);
  EXPECT_EQ(campaign.rows[1].manager, "rosa") << "with a behaviour tree for the mission";
  EXPECT_EQ(campaign.rows[1].search_s.mean(), 251);
  EXPECT_THAT(campaign.unknown, ElementsAre("mine"));
}

TEST(Recorded, WhatIsNoFileOfRunsIsRefusedWithItsPlace) {
  EXPECT_EQ(error_of("a,b\n1,2\n"),
            "runs.csv:1: there is no column \"mission name\"; is it a file of SUAVE's runs?");
  EXPECT_EQ(error_of(std::string(kHead) + "suave bt,x\n"),
            "runs.csv: record 2 has 2 fields, but the head has 8");
  EXPECT_EQ(error_of(std::string(kHead) + "suave bt,x,p,250,True,-1,30,0\n"),
            "runs.csv: record 2: '-1' is no number of at least 0");
  EXPECT_EQ(error_of(std::string(kHead) + "suave bt,x,p,250,True,100,nan,0\n"),
            "runs.csv: record 2: 'nan' is no number of at least 0");
  EXPECT_THAT(error_of(std::string(kHead) + "suave bt,\"x,p,250,True,100,30,0\n"),
              HasSubstr("has 2 fields"))
      << "a quote that is never closed";
}

TEST(Recorded, FilesWithoutARunOfAKnownManagerAreAnError) {
  const std::string path = testing::TempDir() + "/unknown.csv";
  std::ofstream(path) << kHead << "suave mine,x,p,250,True,90,33,0\n";
  EXPECT_EQ(read_recorded({path}).error(), "there is no run of a manager that the study has");
  EXPECT_FALSE(read_recorded({path + ".missing"}));
}

}  // namespace
}  // namespace culprit::study
