#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text_file.h"
#include "plan/paper_planner.h"
#include "web/calls.h"

namespace culprit::web {
namespace {

Answer ask(const Json& body) {
  return what_if_route([] { return std::make_unique<PaperPlanner>(); }).answer(body);
}

Json example() {
  const auto document = parse_json(*read_text("src/web/openapi.json"));
  return document["paths"]["/api/what-if"]["post"]["requestBody"]["content"]["application/json"]
                 ["example"];
}

TEST(WhatIfRoute, PlansForTheExampleOfTheOpenApiDocument) {
  const Answer answer = ask(example());
  ASSERT_EQ(answer.status, 200) << answer.body;
  ASSERT_EQ(answer.body["failures"].size(), 1u) << answer.body;
  EXPECT_EQ(answer.body["failures"][0]["rule"], "CameraSilent");
}

TEST(WhatIfRoute, SaysWhatIsWrongWithTheRulesOrTheState) {
  Json body = example();
  body["state"] = "COMPONENT camra KILLED\n";
  EXPECT_EQ(ask(body).status, 422);
  EXPECT_THAT(ask(body).body["error"].get<std::string>(), testing::HasSubstr("camera"));
  body["rules"] = "RUEL\n";
  EXPECT_EQ(ask(body).status, 422);
  EXPECT_EQ(ask(nullptr).status, 400);
}

}  // namespace
}  // namespace culprit::web
