#include "rule_graph/draft_graph.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::rule_graph {
namespace {

using testing::HasSubstr;

constexpr const char* kRobot = R"(COMPONENT camera NODE /camera
COMPONENT fusion NODE /fusion
DEPENDENCY fusion ON camera
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 1s
    STRATEGY again 50 10
      ADAPTATION camera restart 3
)";

Draft drawn(const std::string& text) {
  auto draft = graph_of_draft(expand(Source("rules", text)));
  if (!draft) throw std::runtime_error(draft.error());
  return *draft;
}

TEST(Draft, WithoutMistakesIsTheGraphOfTheFile) {
  const Draft draft = drawn(kRobot);
  EXPECT_EQ(draft.errors, 0u);
  const Json json = as_json(draft.graph);
  EXPECT_EQ(json["dependencies"], Json::array({{{"consumer", "fusion"}, {"producer", "camera"}}}));
  EXPECT_EQ(json["rules"][0]["adapts"], Json::array({"camera"}));
  EXPECT_EQ(json["rules"][0]["spreads"], Json::array({"fusion"}));
  EXPECT_FALSE(json["rules"][0].contains("mistake"));
}

TEST(Draft, KeepsAllElseWhileARuleIsWritten) {
  const Draft draft = drawn(std::string(kRobot) + R"(RULE FusionBad
  POLICIES ERROR
  TRIGGER age(/fused) > "a"
    STRATEGY again 50 10
      ADAPTATION fusion restart 3
)");
  EXPECT_GE(draft.errors, 1u);
  const Json json = as_json(draft.graph);
  ASSERT_EQ(json["rules"].size(), 2u);
  EXPECT_FALSE(json["rules"][0].contains("mistake"));
  EXPECT_EQ(json["rules"][0]["spreads"], Json::array({"fusion"}));
  EXPECT_EQ(json["rules"][1]["name"], "FusionBad");
  EXPECT_EQ(json["rules"][1]["mistake"], "error");
  EXPECT_EQ(json["rules"][1]["adapts"], Json::array({"fusion"}));
  EXPECT_EQ(json["rules"][1]["line"], 9);
}

TEST(Draft, KeepsAllElseWhileADeclarationIsWrong) {
  const Draft draft = drawn("COMPONENT lidar NODE /lidar\nCOMPONENT lidar NODE /other\n" +
                            std::string(kRobot) + "DEPENDENCY fusion ON\n");
  EXPECT_GE(draft.errors, 2u);
  const Json json = as_json(draft.graph);
  EXPECT_EQ(json["components"].size(), 3u);
  EXPECT_EQ(json["components"][0]["mistake"], "error");
  ASSERT_EQ(json["rules"].size(), 1u);
  EXPECT_FALSE(json["rules"][0].contains("mistake"));
  EXPECT_EQ(json["rules"][0]["adapts"], Json::array({"camera"}));
}

TEST(Draft, MarksWarnings) {
  const Draft draft = drawn(std::string(kRobot) + R"(RULE Never
  POLICIES WARNING
  TRIGGER age(/fused) > 2s && age(/fused) < 1s
    STRATEGY again 50 10
      ADAPTATION fusion restart 3
)");
  EXPECT_GE(draft.errors + draft.warnings, 1u);
  EXPECT_TRUE(as_json(draft.graph)["rules"][1].contains("mistake"));
}

TEST(Draft, HasWhatATemplateStandsFor) {
  const Draft draft = drawn(R"(TEMPLATE driver(name)
COMPONENT {name} NODE /{name}
RULE {name}_silent
  POLICIES ERROR
  TRIGGER age(/{name}/out) > 1s
    STRATEGY again 50 10
      ADAPTATION {name} restart 3
END
USE driver(camera)
)");
  const Json json = as_json(draft.graph);
  EXPECT_EQ(json["components"][0]["name"], "camera");
  EXPECT_EQ(json["rules"][0]["name"], "camera_silent");
  EXPECT_EQ(json["components"][0]["line"], 9) << "where the template is used";
}

TEST(Draft, ThatCannotBePutTogetherIsNotDrawn) {
  const Draft draft = drawn(std::string(kRobot) + "USE driver(camera)\n");
  EXPECT_EQ(draft.errors, 1u);
  EXPECT_TRUE(draft.graph.rules.empty());
}

TEST(Draft, IsNotDrawnIfItIsTooLarge) {
  std::string text;
  for (std::size_t i = 0; i <= kMostDrawn; ++i)
    text += "COMPONENT c" + std::to_string(i) + " NODE /c" + std::to_string(i) + "\n";
  const auto draft = graph_of_draft(expand(Source("rules", text)));
  ASSERT_FALSE(draft);
  EXPECT_THAT(draft.error(), HasSubstr("more than 2000"));
}

TEST(Draft, IsNotDrawnIfItHasTooManyDependencies) {
  constexpr int kMany = 150;  // of either side: 22,500 dependencies
  std::string all;
  for (int i = 0; i < kMany; ++i) all += " b" + std::to_string(i);
  std::string text;
  for (int i = 0; i < kMany; ++i) text += "DEPENDENCY a" + std::to_string(i) + " ON" + all + "\n";
  const auto draft = graph_of_draft(expand(Source("rules", text)));
  ASSERT_FALSE(draft);
  EXPECT_THAT(draft.error(), HasSubstr("20000 dependencies"));
}

TEST(Draft, OfNothingIsEmpty) {
  EXPECT_TRUE(drawn("").graph.components.empty());
  EXPECT_TRUE(drawn("RULE\nRULE\n").graph.rules.empty());
}

}  // namespace
}  // namespace culprit::rule_graph
