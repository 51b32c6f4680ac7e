// What the calls answer, and that openapi.json tells all of them.
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"
#include "web/fault_routes.h"
#include "web/live_routes.h"
#include "web/order_routes.h"
#include "web/rule_routes.h"

namespace culprit::web {
namespace {

using testing::HasSubstr;

constexpr const char* kRules = R"(
COMPONENT camera NODE /camera
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 500ms
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
)";

// All routes that any command serves.
struct Routes : testing::Test {
  Routes() : path(testing::TempDir() + "desk-" + std::to_string(getpid()) + ".rules") {
    Faults faults;
    faults.all = {{"kill:camera", "camera"}};
    faults.inject = [this](const std::string& name) { return injected = name, Expected<void>(); };
    faults.clear = [] { return Expected<void>(); };
    const auto submit = [this](Order order) { orders.push_back(std::move(order)); };
    for (auto routes : {live_routes(hub), rule_routes(desk), fault_routes(std::move(faults)),
                        order_routes(rules, submit)}) {
      for (Route& route : routes) all.push_back(std::move(route));
    }
  }
  ~Routes() override { std::filesystem::remove(path); }

  Answer ask(const std::string& call, const Json& body = nullptr) const {
    for (const Route& route : all) {
      if (std::string(to_string(route.method)) + " " + route.path == call)
        return route.answer(body);
    }
    ADD_FAILURE() << "no route " << call;
    return {};
  }

  const std::string path;
  Hub hub;
  RuleDesk desk{path};
  const RuleSet rules = *check(Source("test", kRules)).rules;
  std::string injected;
  std::vector<Order> orders;
  std::vector<Route> all;
};

Json openapi() {
  std::ifstream file("src/web/openapi.json");
  return Json::parse(file);
}

TEST_F(Routes, AreAllInTheOpenApiDocument) {
  std::set<std::string> told;
  const Json document = openapi();
  for (const auto& [path_told, calls] : document["paths"].items()) {
    for (const auto& [method, call] : calls.items()) told.insert(method + " " + path_told);
  }
  // Of the server itself (server.cpp), and of the commands (cli/what_if_route.cpp).
  std::set<std::string> served{"get /api/about", "get /api/openapi.json", "get /api/stream",
                               "post /api/what-if"};
  for (const Route& route : all)
    served.insert(std::string(to_string(route.method)) + " " + route.path);
  EXPECT_EQ(told, served);
}

TEST_F(Routes, TakeTheExamplesOfTheOpenApiDocument) {
  int examples = 0;
  const Json document = openapi();
  for (const auto& [path_told, calls] : document["paths"].items()) {
    for (const auto& [method, call] : calls.items()) {
      const bool is_of_the_commands = path_told == "/api/what-if";  // cli/what_if_route_test.cpp
      if (!call.contains("requestBody") || is_of_the_commands) continue;
      const Json& example = call["requestBody"]["content"]["application/json"]["example"];
      const Answer answer = ask(method + " " + path_told, example);
      EXPECT_TRUE(call["responses"].contains(std::to_string(answer.status))) << answer.body;
      EXPECT_LT(answer.status, 300) << method << " " << path_told << ": " << answer.body;
      ++examples;
    }
  }
  EXPECT_GE(examples, 6);
}

TEST_F(Routes, RefuseBodiesOfAnyOtherShape) {
  const std::vector<Json> bodies = {nullptr,
                                    1,
                                    "text",
                                    Json::array(),
                                    Json::object(),
                                    {{"text", 1}, {"order", 2}, {"name", Json::array()}},
                                    {{"order", "silence"}, {"component", "nobody"}}};
  for (const Route& route : all) {
    if (route.method != Method::kPost && route.method != Method::kPut) continue;
    for (const Json& body : bodies) EXPECT_GE(route.answer(body).status, 400) << route.path << body;
  }
  EXPECT_TRUE(orders.empty());
}

TEST_F(Routes, CheckATextAsYouType) {
  const Answer answer = ask("post /api/rules/ask", {{"text", "RUEL X\n"}});
  ASSERT_EQ(answer.body["diagnostics"].size(), 1u);
  EXPECT_THAT(answer.body["diagnostics"][0]["message"].get<std::string>(), HasSubstr("RULE"));
}

TEST_F(Routes, SaveTheFileThatWasOpened) {
  const Json opened = ask("get /api/rules").body;
  EXPECT_EQ(opened["text"], "");
  const Answer saved = ask("put /api/rules", {{"text", kRules}, {"version", opened["version"]}});
  EXPECT_EQ(saved.status, 200);
  EXPECT_EQ(ask("get /api/rules").body["text"], kRules);
  EXPECT_EQ(ask("get /api/rules").body["version"], saved.body["version"]);
}

TEST_F(Routes, DoNotOverwriteWhatSomebodyElseHasWritten) {
  const Json opened = ask("get /api/rules").body;
  std::ofstream(path) << "# of somebody else\n";
  const Answer answer = ask("put /api/rules", {{"text", kRules}, {"version", opened["version"]}});
  EXPECT_EQ(answer.status, 409);
  EXPECT_EQ(ask("get /api/rules").body["text"], "# of somebody else\n");
}

TEST_F(Routes, DoNotSaveRulesThatArePartOfTheProgram) {
  RuleDesk built_in("sunset.rules", kRules);
  const auto routes = rule_routes(built_in);
  EXPECT_EQ(routes[0].answer(nullptr).body["can_save"], false);
  EXPECT_EQ(routes[1].answer({{"text", ""}, {"version", ""}}).status, 403);
}

TEST_F(Routes, GiveOrdersToTheManager) {
  const Answer answer = ask("post /api/orders", {{"order", "run"},
                                                 {"rule", "CameraSilent"},
                                                 {"strategy", "restart"},
                                                 {"author", "ada"},
                                                 {"reason", "to see"}});
  EXPECT_EQ(answer.status, 202);
  ASSERT_EQ(orders.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<RunStrategy>(orders[0].what));
  EXPECT_EQ(orders[0].author, "ada");
  EXPECT_EQ(answer.body["number"], orders[0].number);
}

TEST_F(Routes, InjectOnlyFaultsThatExist) {
  EXPECT_EQ(ask("post /api/faults", {{"name", "rm -rf"}}).status, 404);
  EXPECT_EQ(injected, "");
  ask("post /api/faults", {{"name", "kill:camera"}});
  EXPECT_EQ(injected, "kill:camera");
}

}  // namespace
}  // namespace culprit::web
