#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text_file.h"
#include "rca_study/campaign_json.h"
#include "suave_study/suave_record.h"
#include "sunset_study/json.h"
#include "sunset_study/study.h"
#include "web/calls.h"

namespace culprit::lab {
namespace {

http::Answer ask(const Json& body) { return web::single_run_route().answer(body); }

Json example() {
  const auto document = parse_json(*read_text("src/web/openapi.json"));
  return document["paths"]["/api/studies/run"]["post"]["requestBody"]["content"]["application/json"]
                 ["example"];
}

std::set<std::string> types(const Json& events) {
  std::set<std::string> types;
  for (const Json& event : events) types.insert(event["type"].get<std::string>());
  return types;
}

bool is_in_order(const Json& events) {
  return std::is_sorted(events.begin(), events.end(), [](const Json& a, const Json& b) {
    return a["t"].get<double>() < b["t"].get<double>();
  });
}

// The very run that the campaign measured: the same failures at the same times.
TEST(SingleRunRoute, PlaysTheExampleOfTheOpenApiDocumentAsTheCampaignDid) {
  const Json body = example();
  const http::Answer answer = ask(body);
  ASSERT_EQ(answer.status, 200) << answer.body;
  const auto campaign = study::campaign_from_json<study::Campaign>(body["campaign"]);
  const auto study = study::SunsetStudy::make(campaign->rows, campaign->seed);
  const study::RunId id{0, 3};
  const study::SunsetRun played = study->play(id);
  EXPECT_EQ(answer.body["scenario"], played.scenario.name());

  const Json& events = answer.body["events"];
  EXPECT_TRUE(is_in_order(events));
  EXPECT_THAT(types(events), testing::IsSupersetOf({"fault", "failure_detected", "strategy_chosen",
                                                    "failure_resolved"}));
  std::vector<double> resolved_s;
  for (const Json& event : events) {
    if (event["type"] == "failure_resolved")
      resolved_s.push_back(event["reaction_s"].get<double>());
    EXPECT_LE(event["t"].get<double>(), answer.body["end"].get<double>());
  }
  EXPECT_EQ(resolved_s, study->run(id).reactions_s);
}

TEST(SingleRunRoute, PlaysOtherStudiesToo) {
  study::rca::RcaCampaign rca;
  rca.settings = {{20, 2, 0, false}};
  rca.planners = {"naive", "bayes"};
  rca.episodes = 3;
  const http::Answer episode =
      ask({{"study", "rca"}, {"campaign", study::rca::to_json(rca)}, {"row", 1u}, {"run", 2u}});
  ASSERT_EQ(episode.status, 200) << episode.body;
  EXPECT_THAT(types(episode.body["events"]), testing::IsSupersetOf({"fault", "strategy_chosen"}));
  EXPECT_TRUE(is_in_order(episode.body["events"]));

  study::SuaveCampaign suave;
  suave.plan = *suave::model::find_mission_plan("stress");
  suave.generation = *suave::model::find_generation("era");
  suave.managers = {"bt", study::kCulprit};
  suave.runs = 1;
  Json body{{"study", "suave"}, {"campaign", study::to_json(suave)}, {"row", 0u}, {"run", 0u}};
  const http::Answer other = ask(body);
  ASSERT_EQ(other.status, 200) << other.body;
  EXPECT_EQ(other.body["is_told"], false);
  EXPECT_THAT(types(other.body["events"]), testing::ElementsAre("fault", "note"));
  body["row"] = 1u;
  const http::Answer ours = ask(body);
  EXPECT_EQ(ours.body["is_told"], true);
  EXPECT_THAT(types(ours.body["events"]),
              testing::IsSupersetOf(
                  {"fault", "note", "failure_detected", "strategy_chosen", "failure_resolved"}));
  EXPECT_TRUE(is_in_order(ours.body["events"]));
}

TEST(SingleRunRoute, SaysWhatIsWrongWithACampaignOrARun) {
  for (const Json& wrong :
       {Json(), Json(1), Json::array(), Json::object(), Json{{"study", "sunset"}}})
    EXPECT_EQ(ask(wrong).status, 400) << wrong;
  const auto refusal = [](const char* member, const Json& value) {
    Json body = example();
    body[member] = value;
    return ask(body);
  };
  EXPECT_EQ(refusal("run", -1).status, 400);
  EXPECT_EQ(refusal("row", "0").status, 400);
  EXPECT_EQ(refusal("run", 18u).status, 422);
  EXPECT_EQ(refusal("row", 1u).status, 422);
  EXPECT_EQ(refusal("study", "rm").status, 422);
  EXPECT_EQ(refusal("study", "rca").status, 422);
  EXPECT_EQ(refusal("campaign", nullptr).status, 422);
  Json body = example();
  body["campaign"]["rows"][0]["planner"] = "nobody";
  EXPECT_THAT(ask(body).body["error"].get<std::string>(), testing::HasSubstr("nobody"));
}

}  // namespace
}  // namespace culprit::lab
