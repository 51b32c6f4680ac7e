#include "rule_graph/rule_graph.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::rule_graph {
namespace {

RuleGraph graph_in(const std::string& text) {
  const Source source("robot.rules", text);
  return graph_of(*check(source).rules, source);
}

TEST(RuleGraph, TellsWhereAFailureMaySpreadTo) {
  const Json json = as_json(graph_in(R"(COMPONENT camera NODE /camera
COMPONENT fusion NODE /fusion
COMPONENT pilot NODE /pilot
COMPONENT lamp NODE /lamp
DEPENDENCY fusion ON camera
DEPENDENCY pilot ON fusion lamp
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 1s
    STRATEGY again 50 10
      ADAPTATION camera restart 3
RULE PilotSilent
  POLICIES ERROR
  TRIGGER age(/cmd) > 1s
    STRATEGY again 50 10
      ADAPTATION pilot restart 3
)"));
  EXPECT_EQ(json["rules"][0]["spreads"], Json({"fusion", "pilot"}));
  EXPECT_EQ(json["rules"][1]["spreads"], Json::array());
  EXPECT_FALSE(json["rules"][0].contains("mistake"));
}

TEST(RuleGraph, AsDotHoldsHostileNames) {
  EXPECT_EQ(in_dot("a\"]; b [label=\"\\"), "\"a\\\"]; b [label=\\\"\\\\\"");
}

}  // namespace
}  // namespace culprit::rule_graph
