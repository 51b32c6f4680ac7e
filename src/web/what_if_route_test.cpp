#include <atomic>
#include <latch>
#include <sys/resource.h>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text_file.h"
#include "plan/paper_planner.h"
#include "web/aside.h"
#include "web/calls.h"

namespace culprit::web {
namespace {

http::Answer ask(const Json& body) {
  return what_if_route([] { return std::make_unique<PaperPlanner>(); }).answer(body);
}

Json example() {
  const auto document = parse_json(*read_text("src/web/openapi.json"));
  return document["paths"]["/api/what-if"]["post"]["requestBody"]["content"]["application/json"]
                 ["example"];
}

TEST(WhatIfRoute, PlansForTheExampleOfTheOpenApiDocument) {
  const http::Answer answer = ask(example());
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

TEST(WhatIfRoute, MakesFewPlansAtOnceAndWithALowerPriority) {
  constexpr int kAtOnce = FewAtOnce::kMost;
  std::latch all_plan(kAtOnce + 1);
  std::latch is_refused(1);
  std::atomic<int> urgent = 0;
  const http::Route route = what_if_route([&] {
    if (getpriority(PRIO_PROCESS, 0) < FewAtOnce::kLowered) ++urgent;
    all_plan.count_down();
    is_refused.wait();
    return std::make_unique<PaperPlanner>();
  });
  std::atomic<int> planned = 0;
  std::vector<std::jthread> askers;
  for (int i = 0; i < kAtOnce; ++i)
    askers.emplace_back([&] { planned += route.answer(example()).status == 200 ? 1 : 0; });
  all_plan.arrive_and_wait();
  EXPECT_EQ(route.answer(example()).status, 409);
  is_refused.count_down();
  askers.clear();
  EXPECT_EQ(planned, kAtOnce);
  EXPECT_EQ(urgent, 0);
  EXPECT_EQ(ask(example()).status, 200) << "another route has its own places";
}

}  // namespace
}  // namespace culprit::web
