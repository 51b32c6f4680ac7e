#include "rca_study/campaign_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::study::rca {
namespace {

RcaCampaign campaign() {
  RcaCampaign campaign;
  campaign.settings = {{5, 1, 0.1, true, true}, {4, 2, 0, false, false, false, true, true, true}};
  campaign.planners = {"optimum", "bayes"};
  campaign.objective = Objective::kDowntime;
  campaign.episodes = 7;
  campaign.seed = UINT64_MAX;
  campaign.version = "1.0";
  return campaign;
}

TEST(RcaCampaignJson, ComesBackAsItWas) {
  const Json json = to_json(campaign());
  const auto read = campaign_from_json(parse_json(to_line(json)));
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(to_json(*read), json);
}

TEST(RcaCampaignJson, HasItsScenario) {
  RcaCampaign own = campaign();
  own.scenario = generate({4, 1, 0, false}, 3);
  own.scenario->components[0].detector.miss = 1;  // more than random robots have
  own.settings = {setting_of(*own.scenario)};
  const auto read = campaign_from_json(to_json(own));
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(to_json(*read), to_json(own));
}

TEST(RcaCampaignJson, RefusesWhatCannotBePlayed) {
  const auto complaint = [](const char* pointer, const Json& value) {
    Json json = to_json(campaign());
    json[Json::json_pointer(pointer)] = value;
    const auto read = campaign_from_json(json);
    return read ? "" : read.error();
  };
  using testing::HasSubstr;
  EXPECT_THAT(complaint("/settings", Json::array()), HasSubstr("settings has no entry"));
  EXPECT_THAT(complaint("/settings/0/components", 1u), HasSubstr("less than 2"));
  EXPECT_THAT(complaint("/settings/0/faults", 6u), HasSubstr("faults"));
  EXPECT_THAT(complaint("/settings/0/noise", 0.5), HasSubstr("noise"));
  EXPECT_THAT(complaint("/settings/1/components", 50u), HasSubstr("optimum"));
  EXPECT_THAT(complaint("/planners/0", "nobody"), HasSubstr("'nobody'"));
  EXPECT_THAT(complaint("/planners", Json::array()), HasSubstr("planners has no entry"));
  EXPECT_THAT(complaint("/objective", "fame"), HasSubstr("objective"));
  EXPECT_THAT(complaint("/episodes", 0u), HasSubstr("episodes is 0"));
  EXPECT_THAT(complaint("/scenario", Json::object()), HasSubstr("scenario"));
  EXPECT_THAT(complaint("/more", 1), HasSubstr("no"));
  EXPECT_FALSE(campaign_from_json(nullptr));
}

}  // namespace
}  // namespace culprit::study::rca
