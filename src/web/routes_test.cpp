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
#include "web/name_routes.h"
#include "web/order_routes.h"
#include "web/reload_routes.h"
#include "web/rule_routes.h"
#include "web/status_routes.h"
#include "web/study_routes.h"

namespace culprit::web {
namespace {

using testing::HasSubstr;

constexpr const char* kRouteRules = R"(
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
    order_desk.open(rules, [this](Order order) { orders.push_back(std::move(order)); });
    const auto look = [this](const LiveInterest& interest) -> Expected<LiveInventory> {
      looked_at = interest;
      LiveInventory inventory;
      inventory.nodes["/camera"].parameters = {{"gain", Value(0.5)}, {"matrix", std::nullopt}};
      inventory.topics["/rgb"] = {};
      return inventory;
    };
    Studies studies;
    studies.start = [this](const Studies::Campaign& campaign) -> Expected<void> {
      if (started) return Error{"a campaign is running already"};
      return started = campaign, Expected<void>();
    };
    studies.stop = [this] { started.reset(); };
    studies.progress = [this]() -> std::optional<Studies::Progress> {
      if (!started) return std::nullopt;
      return Studies::Progress{*started, "running", 1, {}, "", false};
    };
    studies.result = studies.report = [] { return std::string("<h1>sunset</h1>"); };
    const auto reload = [this](const std::string& author) -> Expected<std::size_t> {
      if (is_file_wrong) return Error{"line 3: no such rule"};
      reloaded_by = author;
      return 1;
    };
    for (auto routes : {live_routes(hub), rule_routes(desk), fault_routes(std::move(faults)),
                        order_routes(order_desk), status_routes(hub, metrics),
                        reload_routes(reload), study_routes(studies), name_routes(look)}) {
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
  Metrics metrics;
  RuleDesk desk{path};
  const RuleSet rules = *check(Source("test", kRouteRules)).rules;
  live::OrderKeeper keeper{"this is a test"};
  OrderDesk order_desk{keeper.keeping()};
  bool is_file_wrong = false;
  std::string reloaded_by;
  std::optional<Studies::Campaign> started;
  LiveInterest looked_at;
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
  // Of the server itself (server.cpp), and of the commands (cli/what_if_route.cpp,
  // cli/single_run_route.cpp).
  std::set<std::string> served{"get /api/about", "get /api/openapi.json", "get /api/stream",
                               "post /api/what-if", "post /api/studies/run"};
  for (const Route& route : all)
    served.insert(std::string(to_string(route.method)) + " " + route.path);
  EXPECT_EQ(told, served);
}

TEST_F(Routes, TakeTheExamplesOfTheOpenApiDocument) {
  int examples = 0;
  const Json document = openapi();
  for (const auto& [path_told, calls] : document["paths"].items()) {
    for (const auto& [method, call] : calls.items()) {
      // cli/what_if_route_test.cpp, cli/single_run_route_test.cpp
      const bool is_of_the_commands =
          path_told == "/api/what-if" || path_told == "/api/studies/run";
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
  const Answer saved =
      ask("put /api/rules", {{"text", kRouteRules}, {"version", opened["version"]}});
  EXPECT_EQ(saved.status, 200);
  EXPECT_EQ(ask("get /api/rules").body["text"], kRouteRules);
  EXPECT_EQ(ask("get /api/rules").body["version"], saved.body["version"]);
}

TEST_F(Routes, DoNotOverwriteWhatSomebodyElseHasWritten) {
  const Json opened = ask("get /api/rules").body;
  std::ofstream(path) << "# of somebody else\n";
  const Answer answer =
      ask("put /api/rules", {{"text", kRouteRules}, {"version", opened["version"]}});
  EXPECT_EQ(answer.status, 409);
  EXPECT_EQ(ask("get /api/rules").body["text"], "# of somebody else\n");
}

TEST_F(Routes, DoNotSaveRulesThatArePartOfTheProgram) {
  RuleDesk built_in("sunset.rules", kRouteRules);
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

TEST_F(Routes, ForgetWhatWasLearned) {
  EXPECT_EQ(ask("post /api/orders", {{"order", "forget"}, {"author", "ada"}}).status, 202);
  const Json wrong{{"order", "forget"}, {"author", "ada"}, {"rule", "nothing"}};
  EXPECT_EQ(ask("post /api/orders", wrong).status, 400) << "that would be all rules";
  ASSERT_EQ(orders.size(), 1u);
  EXPECT_FALSE(std::get<Forget>(orders[0].what).rule);
}

TEST_F(Routes, TakeNoOrdersWhileTheRulesAreReplaced) {
  order_desk.close();
  EXPECT_EQ(ask("post /api/orders", {{"order", "resume"}, {"author", "ada"}}).status, 503);
  EXPECT_TRUE(orders.empty());
}

TEST_F(Routes, TakeAPauseAlsoWhileTheRulesAreReplaced) {
  order_desk.close();
  EXPECT_EQ(ask("post /api/orders", {{"order", "pause"}, {"author", "ada"}}).status, 202);
  EXPECT_TRUE(orders.empty());
  order_desk.open(rules, [this](Order order) { orders.push_back(std::move(order)); });
  ASSERT_EQ(orders.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<Pause>(orders[0].what));
}

TEST_F(Routes, SayWhetherAnOrderIsKept) {
  const Answer answer = ask("post /api/orders", {{"order", "pause"}, {"author", "ada"}});
  EXPECT_EQ(answer.status, 202);
  EXPECT_EQ(answer.body["kept"], false);
  EXPECT_EQ(answer.body["text"], "in force, not kept: this is a test");
  OrderDesk strict([](const Order&, const RuleSet&) -> live::KeepOrder {
    return [](const std::function<void()>&) -> live::Kept {
      return {false, false, "the disk is full"};
    };
  });
  strict.open(rules, [this](Order order) { orders.push_back(std::move(order)); });
  orders.clear();
  const Answer refused = strict.take({{"order", "resume"}, {"author", "ada"}});
  EXPECT_EQ(refused.status, 503);
  EXPECT_THAT(refused.body["error"].get<std::string>(), HasSubstr("the disk is full"));
  EXPECT_TRUE(orders.empty());
}

TEST_F(Routes, ExportWhatWasLearned) {
  hub.publish(Kind::kRobot, R"({"rules": [{"name": "R", "strategies": [
      {"name": "s", "prior": [9, 1]}, {"name": "t", "prior": [5, 5]}]}]})");
  hub.publish(Kind::kState, R"({"beliefs": [[10, 1], [5, 5]], "couplings": [[0, 0, 2, 1]]})");
  const Json learned = ask("get /api/beliefs").body;
  EXPECT_EQ(learned["beliefs"].dump(),
            R"([{"rule":"R","strategy":"s","belief":[10,1],"prior":[9,1]}])");
  EXPECT_EQ(learned["couplings"].dump(), R"([{"cause":"R","effect":"R","cleared":2,"stayed":1}])");
}

TEST_F(Routes, ReloadOnlyRulesWithoutErrors) {
  EXPECT_EQ(ask("post /api/rules/reload", {{"author", "ada"}}).status, 202);
  EXPECT_EQ(reloaded_by, "ada");
  is_file_wrong = true;
  const Answer refused = ask("post /api/rules/reload", {{"author", "ada"}});
  EXPECT_EQ(refused.status, 422);
  EXPECT_THAT(refused.body["error"].get<std::string>(), HasSubstr("line 3"));
}

TEST_F(Routes, OfferWhatTheRobotHasAndDisturbItNoMoreThanNeeded) {
  const Json names = ask("post /api/rules/names", {{"text", kRouteRules}}).body;
  EXPECT_EQ(names["nodes"].dump(), R"({"/camera":{"parameters":{"gain":0.5,"matrix":null}}})");
  EXPECT_EQ(names["topics"].dump(), R"(["/rgb"])");
  EXPECT_THAT(looked_at.nodes, testing::ElementsAre("/camera"));
  EXPECT_TRUE(looked_at.fields_of_topics.empty());
}

TEST_F(Routes, RunOneStudyAtATime) {
  EXPECT_EQ(ask("get /api/studies").body["study"], nullptr);
  for (const Json& wrong :
       {Json{{"study", "rm"}, {"runs", 1}}, Json{{"study", "rca"}},
        Json{{"study", "rca"}, {"runs", -1}}, Json{{"study", "rca"}, {"runs", 1e12}},
        Json{{"study", "rca"}, {"runs", 1}, {"seed", "x"}}})
    EXPECT_EQ(ask("post /api/studies", wrong).status, 400) << wrong;
  const Json right{{"study", "rca"}, {"runs", 3}, {"seed", 7}};
  EXPECT_EQ(ask("post /api/studies", right).status, 202);
  EXPECT_EQ(started->runs, 3u);
  EXPECT_EQ(ask("post /api/studies", right).status, 409);
  EXPECT_EQ(ask("get /api/studies").body["state"], "running");
  EXPECT_EQ(ask("delete /api/studies").body["study"], nullptr);
  // A report is a page, which must not speak for the app.
  EXPECT_THAT(ask("get /api/studies/report").text->policy, HasSubstr("sandbox"));
}

TEST_F(Routes, InjectOnlyFaultsThatExist) {
  EXPECT_EQ(ask("post /api/faults", {{"name", "rm -rf"}}).status, 404);
  EXPECT_EQ(injected, "");
  ask("post /api/faults", {{"name", "kill:camera"}});
  EXPECT_EQ(injected, "kill:camera");
}

}  // namespace
}  // namespace culprit::web
