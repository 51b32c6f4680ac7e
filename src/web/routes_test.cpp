// The answers of the calls, and that openapi.json describes all of them.
#include <filesystem>
#include <fstream>
#include <set>
#include <sys/stat.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "base/text_file.h"
#include "journal/session.h"
#include "journal/writer.h"
#include "language/checker.h"
#include "recorder/recording_folder.h"
#include "web/calls.h"
#include "web/order_routes.h"

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
                        order_routes(order_desk, hub), status_routes(hub, metrics),
                        reload_routes(reload), study_routes(studies), name_routes(look),
                        incident_routes(hub, journal, recordings.path()),
                        recording_routes([this](const std::string& why) { return record(why); }),
                        doctor_routes([this](Duration time) {
                          examined_for = time;
                          return Expected<Json>(Json{{"findings", Json::array()}});
                        })}) {
      for (http::Route& route : routes) all.push_back(std::move(route));
    }
    const auto log_of = [](const std::string& node) -> Expected<std::vector<ros2::msg::Log>> {
      return std::vector<ros2::msg::Log>{{{7, 500'000'000}, 30, node, "it is dark", "", "", 0}};
    };
    all.push_back(component_route(hub, histories.usage, look, log_of));
    all.push_back(map_route([this](const std::string& topic, std::uint64_t known) {
      map_asked = {topic, known};
      return map;
    }));
    all.push_back(series_route(histories));
    all.push_back(past_series_route(""));
    all.push_back(hindsight_route([](const std::string&) -> Expected<std::filesystem::path> {
      return Error{"nothing is recorded here"};
    }));
  }
  ~Routes() override {
    std::filesystem::remove(path);
    std::filesystem::remove(journal);
  }

  http::Answer ask(const std::string& call, const Json& body = nullptr) const {
    for (const http::Route& route : all) {
      if (std::string(to_string(route.method)) + " " + route.path == call)
        return route.answer(body);
    }
    ADD_FAILURE() << "no route " << call;
    return {};
  }

  // As the black box does.
  Expected<std::filesystem::path> record(const std::string& why) const {
    const auto file = recordings / recorder::recording_name("rover", wall_now(), why);
    std::ofstream(file) << "what was heard";
    return file;
  }

  const std::string path;
  const std::string journal = path + ".journal";
  const test::TestFolder recordings;
  Duration examined_for{};
  http::Hub hub;
  Metrics metrics;
  Histories histories;
  RuleDesk desk{path};
  const RuleSet rules = *check(Source("test", kRouteRules)).rules;
  live::OrderKeeper keeper{"this is a test"};
  OrderDesk order_desk{keeper.keeping()};
  bool is_file_wrong = false;
  std::string reloaded_by;
  std::optional<Studies::Campaign> started;
  LiveInterest looked_at;
  Expected<link::MapPicture> map = link::MapPicture{};
  std::pair<std::string, std::uint64_t> map_asked;
  std::string injected;
  std::vector<Order> orders;
  std::vector<http::Route> all;
};

Json openapi() { return parse_json(*read_text("src/web/openapi.json")); }

TEST_F(Routes, AreAllInTheOpenApiDocument) {
  std::set<std::string> told;
  const Json document = openapi();
  for (const auto& [path_told, calls] : document["paths"].items()) {
    for (const auto& [method, call] : calls.items()) told.insert(method + " " + path_told);
  }
  // The calls of the server itself (server.cpp), and of the commands (cli/what_if_route.cpp,
  // cli/single_run_route.cpp).
  std::set<std::string> served{"get /api/about", "get /api/openapi.json", "get /api/stream",
                               "post /api/what-if", "post /api/studies/run"};
  for (const http::Route& route : all)
    served.insert(std::string(to_string(route.method)) + " " + route.path);
  EXPECT_EQ(told, served);
}

TEST_F(Routes, TakeTheExamplesOfTheOpenApiDocument) {
  int examples = 0;
  const Json document = openapi();
  for (const auto& [path_told, calls] : document["paths"].items()) {
    for (const auto& [method, call] : calls.items()) {
      // cli/what_if_route_test.cpp, cli/single_run_route_test.cpp
      const bool is_of_the_commands = path_told == "/api/what-if" ||
                                      path_told == "/api/studies/run" ||
                                      path_told == "/api/rules/replay";
      if (!call.contains("requestBody") || is_of_the_commands) continue;
      const Json& example = call["requestBody"]["content"]["application/json"]["example"];
      const http::Answer answer = ask(method + " " + path_told, example);
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
  for (const http::Route& route : all) {
    if (route.method != http::Method::kPost && route.method != http::Method::kPut) continue;
    for (const Json& body : bodies) EXPECT_GE(route.answer(body).status, 400) << route.path << body;
  }
  EXPECT_TRUE(orders.empty());
}

TEST_F(Routes, CheckATextAsYouType) {
  const http::Answer answer = ask("post /api/rules/ask", {{"text", "RUEL X\n"}});
  ASSERT_EQ(answer.body["diagnostics"].size(), 1u);
  EXPECT_THAT(answer.body["diagnostics"][0]["message"].get<std::string>(), HasSubstr("RULE"));
}

TEST_F(Routes, DrawATextAsYouType) {
  const Json drawn = ask("post /api/rules/graph", {{"text", kRouteRules}}).body;
  EXPECT_EQ(drawn["errors"], 0);
  EXPECT_EQ(drawn["components"][0]["name"], "camera");
  EXPECT_EQ(drawn["rules"][0]["adapts"], Json::array({"camera"}));
  const http::Answer wrong =
      ask("post /api/rules/graph", {{"text", std::string(kRouteRules) + "RULE Second\n"}});
  EXPECT_EQ(wrong.status, 200);
  EXPECT_EQ(wrong.body["rules"][1]["mistake"], "error");
  EXPECT_FALSE(wrong.body["rules"][0].contains("mistake"));
  std::string large;
  for (int i = 0; i < 2001; ++i) large += "COMPONENT c" + std::to_string(i) + " NODE /c\n";
  EXPECT_EQ(ask("post /api/rules/graph", {{"text", large}}).status, 422);
}

TEST_F(Routes, SaveTheFileThatWasOpened) {
  const Json opened = ask("get /api/rules").body;
  EXPECT_EQ(opened["text"], "");
  const http::Answer saved =
      ask("put /api/rules", {{"text", kRouteRules}, {"version", opened["version"]}});
  EXPECT_EQ(saved.status, 200);
  EXPECT_EQ(ask("get /api/rules").body["text"], kRouteRules);
  EXPECT_EQ(ask("get /api/rules").body["version"], saved.body["version"]);
}

TEST_F(Routes, DoNotOverwriteWhatSomebodyElseHasWritten) {
  const Json opened = ask("get /api/rules").body;
  std::ofstream(path) << "# of somebody else\n";
  const http::Answer answer =
      ask("put /api/rules", {{"text", kRouteRules}, {"version", opened["version"]}});
  EXPECT_EQ(answer.status, 409);
  EXPECT_EQ(ask("get /api/rules").body["text"], "# of somebody else\n");
}

// A page reads no more of the computer than the rule file does.
TEST(RuleDesk, IncludesForAPageWhatIsBesideTheFile) {
  namespace fs = std::filesystem;
  const fs::path top = fs::path(testing::TempDir()) / ("desk-" + std::to_string(getpid()));
  const auto write = [&](const std::string& name, const std::string& text) {
    fs::create_directories((top / name).parent_path());
    std::ofstream(top / name) << text;
  };
  write("robot/robot.rules", "");
  write("robot/parts/a.rules", "CONST a = 1\n");
  write("secret.rules", "hidden\n");
  RuleDesk desk((top / "robot/robot.rules").string());
  const auto said = [&](const std::string& text) {
    for (const http::Route& route : rule_routes(desk)) {
      if (route.path == "/api/rules/ask")
        return to_line(route.answer({{"text", text}}).body["diagnostics"]);
    }
    return std::string("no such route");
  };
  EXPECT_EQ(said("INCLUDE \"parts/a.rules\"\nCONST b = a\n"), "[]");
  EXPECT_EQ(said("INCLUDE \"cookbook/battery_low.rules\"\n"), "[]");
  const std::string up = "INCLUDE \"../secret.rules\"\n";
  EXPECT_THAT(said(up), HasSubstr("from the page, only files"));
  EXPECT_THAT(said("INCLUDE \"/etc/passwd.rules\"\n"), HasSubstr("from the page, only files"));
  write("robot/robot.rules", up);  // whoever may write the file may include what he likes
  EXPECT_THAT(said(up), HasSubstr("hidden"));
  fs::remove_all(top);
}

TEST_F(Routes, KeepWhatIsIncludedAndUsedAsItIsWritten) {
  const std::string text =
      "INCLUDE \"packs/nav2.rules\"\n\nTEMPLATE t(a)\n  CONST {a} = 1\nEND\nUSE t(b)\n";
  const Json json = ask("post /api/rules/json", {{"text", text}}).body;
  EXPECT_EQ(ask("post /api/rules/text", json).body["text"], text);
}

TEST_F(Routes, DoNotSaveRulesThatArePartOfTheProgram) {
  RuleDesk built_in("sunset.rules", kRouteRules);
  const auto routes = rule_routes(built_in);
  EXPECT_EQ(routes[0].answer(nullptr).body["can_save"], false);
  EXPECT_EQ(routes[1].answer({{"text", ""}, {"version", ""}}).status, 403);
}

// A client that may change a threshold may not for that reason run programs on the robot.
TEST(RuleDesk, LetsAPageChangeWhatIsExecutedOnlyIfThatWasAllowed) {
  const test::TestFolder folder;
  const std::string file = folder / "robot.rules";
  const std::string before = R"(
CONST limit = 500ms
COMPONENT camera NODE /camera LAUNCH "camera driver" SETUP /opt/ros/setup.bash ENV "A=1" CWD /srv
COMPONENT lidar NODE /lidar UNIT lidar.service
COMPONENT box NODE /box
COMPONENT detect NODE /detect IN /box PLUGIN detect::Detector
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > limit
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
    STRATEGY reset 50 10
      ADAPTATION camera call ~/reset 3
)";
  std::ofstream(file) << before;
  RuleDesk desk(file, RuleDesk::Commands::kStay);
  // Why it is refused; empty: it is saved, and the file is as before.
  const auto refusal = [&](RuleDesk& to, const std::string& text) -> std::string {
    const auto outcome = to.save(text, to.read()->version);
    const auto* refused = std::get_if<RuleDesk::Refusal>(&outcome);
    std::ofstream(file) << before;
    return refused != nullptr ? refused->message : "";
  };
  const auto changed = [&](const std::string& what, const std::string& to) {
    std::string text = before;
    const auto at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), to);
  };
  EXPECT_EQ(refusal(desk, changed("500ms", "700ms")), "");
  EXPECT_EQ(refusal(desk, changed("restart 50 10", "restart 60 10")), "");
  EXPECT_EQ(refusal(desk, before + "# a note\n"), "");
  for (const auto& [what, to] : std::vector<std::pair<std::string, std::string>>{
           {"camera driver", "rm driver"},
           {"/opt/ros/setup.bash", "/tmp/setup.bash"},
           {"\"A=1\"", "\"LD_PRELOAD=/tmp/x.so\""},
           {"CWD /srv", "CWD /tmp"},
           {"lidar.service", "sshd.service"},
           {"detect::Detector", "other::Plugin"},
           {"call ~/reset", "call /shut_down"},
           {"NODE /camera", "NODE /other"},
           {"COMPONENT box", "COMPONENT more NODE /more LAUNCH \"more\"\nCOMPONENT box"}}) {
    const std::string text = changed(what, to);
    EXPECT_THAT(refusal(desk, text), HasSubstr("this changes what is executed")) << to;
    RuleDesk free(file, RuleDesk::Commands::kMayChange);
    EXPECT_EQ(refusal(free, text), "") << to;
  }
  // A detour by an unreadable text.
  EXPECT_THAT(refusal(desk, "COMPONENT"), HasSubstr("could change what is executed"));
  std::ofstream(file) << "COMPONENT";
  const auto outcome = desk.save(before, desk.read()->version);
  EXPECT_TRUE(std::holds_alternative<RuleDesk::Refusal>(outcome));
}

// Reading one could wait for ever.
TEST(RuleDesk, TakesNoPipeForAFile) {
  const test::TestFolder folder;
  const std::string pipe = folder / "robot.rules";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(RuleDesk(pipe).read().error(), HasSubstr("no regular file"));
}

TEST_F(Routes, EscapeWhatWouldSteerATerminal) {
  EXPECT_EQ(
      ask("post /api/orders", {{"order", "pause"}, {"author", "ada\x1b[2J"}, {"reason", "a\nb"}})
          .status,
      202);
  ASSERT_EQ(orders.size(), 1u);
  EXPECT_EQ(orders[0].author, "ada\\x1b[2J");
  EXPECT_EQ(orders[0].reason, "a\\x0ab");
  EXPECT_EQ(ask("post /api/rules/reload", {{"author", "eve\r"}}).status, 202);
  EXPECT_EQ(reloaded_by, "eve\\x0d");
}

TEST_F(Routes, GiveOrdersToTheManager) {
  const http::Answer answer = ask("post /api/orders", {{"order", "run"},
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
  const http::Answer answer = ask("post /api/orders", {{"order", "pause"}, {"author", "ada"}});
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
  const http::Answer refused = strict.take({{"order", "resume"}, {"author", "ada"}});
  EXPECT_EQ(refused.status, 503);
  EXPECT_THAT(refused.body["error"].get<std::string>(), HasSubstr("the disk is full"));
  EXPECT_TRUE(orders.empty());
}

// The manager's reply, as HubObserver publishes it.
Json word(const char* type, std::uint64_t number) {
  return {
      {"type", type}, {"number", number}, {"text", "ada: pause"}, {"refused_because", "so it is"}};
}

TEST_F(Routes, AnswerWithTheManagersWordWhereItIsWaitedFor) {
  const auto tell = [this](const char* type) {
    order_desk.open(rules, [this, type](const Order& order) {
      hub.publish(http::Kind::kEvent, to_line(word(type, order.number + 1)));  // of another one
      hub.publish(http::Kind::kEvent, to_line(word(type, order.number)));
    });
  };
  const Json pause{{"order", "pause"}, {"author", "ada"}, {"wait_s", 20}};
  tell("order_accepted");
  const http::Answer accepted = ask("post /api/orders", pause);
  EXPECT_EQ(accepted.status, 200);
  EXPECT_EQ(accepted.body["order"], "ada: pause");
  EXPECT_EQ(accepted.body["kept"], false);
  tell("order_refused");
  const http::Answer refused = ask("post /api/orders", pause);
  EXPECT_EQ(refused.status, 409);
  EXPECT_EQ(refused.body["error"], "so it is");
}

TEST_F(Routes, SayWhenTheManagerDoesNotTakeAnOrderInTime) {
  const Json pause{{"order", "pause"}, {"author", "ada"}, {"wait_s", 0.01}};
  EXPECT_EQ(ask("post /api/orders", pause).status, 202);
  EXPECT_EQ(orders.size(), 1u) << "it takes it when it comes round";
}

// A culprit that was stopped and goes on receives orders that their senders have given up.
TEST_F(Routes, DoNotFollowAnOrderThatCameTooLateUnlessItRestrains) {
  Json order{{"order", "resume"}, {"author", "ada"}, {"valid_until", 0.001}};
  EXPECT_EQ(ask("post /api/orders", order).status, 408);
  EXPECT_TRUE(orders.empty());
  order["order"] = "pause";
  EXPECT_EQ(ask("post /api/orders", order).status, 202);
  EXPECT_EQ(orders.size(), 1u);
  order["order"] = "resume";
  order["valid_until"] = 1e12;
  EXPECT_EQ(ask("post /api/orders", order).status, 202);
}

TEST_F(Routes, ExportWhatWasLearned) {
  hub.publish(http::Kind::kRobot, R"({"rules": [{"name": "R", "strategies": [
      {"name": "s", "prior": [9, 1]}, {"name": "t", "prior": [5, 5]}]}]})");
  hub.publish(http::Kind::kState, R"({"beliefs": [[3, 7], [5, 5]], "priors": [[2, 7], [5, 5]]})");
  hub.publish(http::Kind::kLearned, R"({
      "couplings": [[0, 0, 2, 1, 6.5]], "latencies": [[0, 3, 0.5, 2.25]],
      "coincidences": [[0, 0, 4], [0, 7, 2]]})");
  const Json learned = ask("get /api/beliefs").body;
  EXPECT_EQ(to_line(learned["beliefs"]),
            R"([{"rule":"R","strategy":"s","belief":[3,7],"prior":[2,7]}])")
      << "from what it began, which a fleet may have told";
  EXPECT_EQ(to_line(learned["couplings"]),
            R"([{"cause":"R","effect":"R","cleared":2,"stayed":1,"spared":6.5}])");
  EXPECT_EQ(to_line(learned["latencies"]),
            R"([{"rule":"R","count":3,"least_s":0.5,"most_s":2.25}])");
  EXPECT_EQ(to_line(learned["coincidences"]), R"([{"rule":"R","other":"R","count":4}])");
}

TEST_F(Routes, ReloadOnlyRulesWithoutErrors) {
  EXPECT_EQ(ask("post /api/rules/reload", {{"author", "ada"}}).status, 202);
  EXPECT_EQ(reloaded_by, "ada");
  is_file_wrong = true;
  const http::Answer refused = ask("post /api/rules/reload", {{"author", "ada"}});
  EXPECT_EQ(refused.status, 422);
  EXPECT_THAT(refused.body["error"].get<std::string>(), HasSubstr("line 3"));
}

TEST_F(Routes, OfferWhatTheRobotHasAndDisturbItNoMoreThanNeeded) {
  const Json names = ask("post /api/rules/names", {{"text", kRouteRules}}).body;
  EXPECT_EQ(to_line(names["nodes"]), R"({"/camera":{"parameters":{"gain":0.5,"matrix":null}}})");
  EXPECT_EQ(to_line(names["topics"]), R"(["/rgb"])");
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

// ---- incidents

Json incident_event(const char* type, double t, Json more = Json::object()) {
  Json event{{"t", t}, {"clock", 1'800'000'000 + t}, {"type", type}, {"text", type}};
  event.update(more);
  return event;
}

Json incident_told(const char* type, double t) {
  return incident_event(type, t,
                        {{"text", ""},
                         {"incident", "mywpiwzf-0k7"},
                         {"rule", "R"},
                         {"components", {"camera"}},
                         {"certain", true},
                         {"criticality", "ERROR"},
                         {"how", "resolved"}});
}

TEST_F(Routes, TellIncidentsOfTheStreamWhereThereIsNoJournal) {
  hub.publish(http::Kind::kRobot,
              R"({"rules": [{"name": "R", "components": ["camera"], "strategies": [
      {"name": "s", "components": ["camera"]}]}]})");
  for (const Json& event :
       {incident_event("failure_detected", 10, {{"rule", "R"}, {"criticality", "ERROR"}}),
        incident_told("incident_opened", 10),
        incident_event("strategy_chosen", 10.1, {{"rule", "R"}, {"strategy", "s"}}),
        incident_event("failure_resolved", 12, {{"rule", "R"}, {"strategy", "s"}}),
        incident_told("incident_closed", 12)})
    hub.publish(http::Kind::kEvent, to_line(event));
  const http::Answer answer = ask("get /api/incidents", {{"since", "0"}});
  ASSERT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body["journal"], nullptr);
  ASSERT_EQ(answer.body["incidents"].size(), 1u);
  const Json& incident = answer.body["incidents"][0];
  EXPECT_EQ(to_line(incident["causes"]), R"(["camera"])");
  EXPECT_EQ(to_line(incident["helped"]), R"(["s"])");
  EXPECT_EQ(incident["seconds"], 2);
  const Json range{{"first", to_line(incident["first"])},
                   {"last", to_line(incident["last"])},
                   {"from", "stream"}};
  const Json told = ask("get /api/incidents/events", range).body["events"];
  ASSERT_EQ(told.size(), 3u);
  EXPECT_EQ(told[2]["t"], 1'800'000'012);
  const http::Answer page =
      ask("get /api/incidents/page", {{"id", incident["id"]}, {"from", "stream"}});
  ASSERT_TRUE(page.text) << page.body;
  EXPECT_EQ(page.text->type, "text/html; charset=utf-8");
  EXPECT_THAT(page.text->content,
              testing::AllOf(HasSubstr("<h1>camera, 2027-01-1"), HasSubstr("need a journal"),
                             HasSubstr("strategy_chosen")));
  EXPECT_EQ(ask("get /api/incidents/page", {{"id", "abc"}, {"from", "stream"}}).status, 404);
  for (const char* wrong : {"", "--help", "-o", "a b", "../x", "zzzzzzzzzzzzzzzzzzzzzzzz"})
    EXPECT_EQ(ask("get /api/incidents/page", {{"id", wrong}}).status, 400) << wrong;
  EXPECT_EQ(ask("get /api/incidents/page").status, 400);
}

TEST_F(Routes, TellIncidentsOfTheJournalAsTheStreamWould) {
  {
    auto writer = journal::Writer::open(journal, {});
    ASSERT_TRUE(writer) << writer.error();
    journal::Session session;
    session.rules_text = kRouteRules;
    session.planner = Json::object();
    const Json detected{{"type", "failure_detected"},
                        {"rule", "CameraSilent"},
                        {"criticality", "ERROR"},
                        {"text", "CameraSilent detected"},
                        {"time", 5'000'000'000}};
    const Json chosen{{"type", "strategy_chosen"},
                      {"rule", "CameraSilent"},
                      {"strategy", "restart"},
                      {"candidates",
                       {{{"strategy", "restart"},
                         {"cost", 0.5},
                         {"excluded", "tried"},
                         {"because", "it was tried"}}}},
                      {"text", "chosen"},
                      {"time", 5'100'000'000}};
    journal::Batch batch;
    for (const auto& [kind, body] : {std::pair{journal::kind::kSession, journal::to_json(session)},
                                     {journal::kind::kEvent, detected},
                                     {journal::kind::kEvent, chosen}})
      batch.entries.push_back({0, 1'800'000'000'000'000'000, std::string(kind), to_line(body)});
    ASSERT_TRUE(writer->append(batch, 1'800'000'000'000'000'000, journal::Durability::kProcessEnd));
  }
  const Json list = ask("get /api/incidents", {{"since", "1799999999.5"}}).body;
  EXPECT_EQ(list["journal"], journal);
  ASSERT_EQ(list["incidents"].size(), 1u) << list;
  EXPECT_EQ(list["incidents"][0]["over"], false);
  const Json& incident = list["incidents"][0];
  const Json range{{"first", to_line(incident["first"])}, {"last", to_line(incident["last"])}};
  const Json told = ask("get /api/incidents/events", range).body["events"];
  ASSERT_EQ(told.size(), 2u) << told;
  EXPECT_EQ(told[0]["label"], "detected");
  EXPECT_EQ(told[0]["severity"], "error");
  EXPECT_EQ(told[1]["clock"], 1'800'000'000.1);
  EXPECT_EQ(to_line(told[1]["components"]), R"(["camera"])");
  EXPECT_EQ(told[1]["candidates"][0]["excluded"]["text"], "it was tried");
}

TEST_F(Routes, TakeOnlyNumbersBehindTheQuestionMark) {
  for (const Json& wrong : {Json(nullptr), Json{{"since", "yesterday"}}, Json{{"since", "1e999"}},
                            Json{{"since", "-1"}}, Json{{"since", "nan"}}, Json{{"since", "1 "}}})
    EXPECT_EQ(ask("get /api/incidents", wrong).status, 400) << wrong;
  EXPECT_EQ(ask("get /api/incidents/events", {{"first", "1"}}).status, 400);
  EXPECT_EQ(ask("get /api/incidents/events", {{"first", "1"}, {"last", "2"}}).status, 503)
      << "there is no journal yet";
}

TEST_F(Routes, TellWhichRecordingsAnIncidentHasAndGiveThemAndNoOtherFile) {
  const double now = static_cast<double>(wall_now()) * 1e-9;
  for (const double began : {now - 1000, now - 1}) {
    for (const char* type : {"incident_opened", "incident_closed"}) {
      Json event = incident_told(type, 0);
      event["incident"] = began < now - 500 ? "mywpiwzf-0k7" : "mywpiwzf-0k8";
      event["t"] = event["clock"] = began + (type == std::string("incident_opened") ? 0 : 0.5);
      hub.publish(http::Kind::kEvent, to_line(event));
    }
  }
  const Json made = ask("post /api/recordings", {{"reason", "Dead"}}).body;
  std::ofstream(recordings / "secret") << "not for everybody";
  const Json incidents = ask("get /api/incidents", {{"since", "0"}}).body["incidents"];
  ASSERT_EQ(incidents.size(), 2u) << incidents;
  EXPECT_EQ(incidents[1]["recordings"], Json::array()) << "it was long before";
  ASSERT_EQ(incidents[0]["recordings"].size(), 1u) << incidents;
  const Json& recording = incidents[0]["recordings"][0];
  EXPECT_EQ(recording["path"], made["recording"]);
  EXPECT_EQ(recording["bytes"], 14);
  const http::Answer given = ask("get /api/incidents/recording", {{"name", recording["name"]}});
  ASSERT_TRUE(given.file);
  EXPECT_EQ(given.file->path, made["recording"]);
  const std::string name = recording["name"];
  std::filesystem::create_symlink(recordings / "secret",
                                  recordings / recorder::recording_name("rover", 0, "link"));
  for (const std::string& other :
       {std::string("secret"), "../" + recordings.path().filename().string() + "/" + name,
        "./" + name, recordings.path().string() + "/" + name, std::string("..%2f"),
        recorder::recording_name("rover", 0, "link"), std::string()})
    EXPECT_EQ(ask("get /api/incidents/recording", {{"name", other}}).status, 404) << other;
  EXPECT_EQ(ask("get /api/incidents/recording").status, 400);
}

TEST(RecordingRoutes, SayWhatToDoWhereNothingIsRecorded) {
  const http::Answer answer = recording_routes({}).front().answer(nullptr);
  EXPECT_EQ(answer.status, 409);
  EXPECT_THAT(answer.body["error"].get<std::string>(), HasSubstr("--record"));
}

// ---- one component, and the doctor

TEST_F(Routes, TellWhatAComponentUsesAndLogged) {
  hub.publish(http::Kind::kRobot, R"({"components": [{"name": "lidar"}, {"name": "camera"}]})");
  hub.publish(http::Kind::kGraph, R"({"nodes": [{"node": "/camera", "component": "camera"}]})");
  hub.publish(http::Kind::kState, to_line({{"components", {Json::object(), {{"pid", getpid()}}}}}));
  const Json camera = ask("get /api/component", {{"name", "camera"}}).body;
  EXPECT_EQ(camera["process"]["pid"], getpid());
  EXPECT_GT(camera["process"]["memory"], 1'000'000);
  EXPECT_EQ(camera["usage"], Json::array()) << "nobody has looked yet";
  EXPECT_EQ(camera["parameters"]["gain"], 0.5);
  EXPECT_EQ(to_line(camera["log"]), R"([{"clock":7.5,"level":"warning","text":"it is dark"}])");
  EXPECT_THAT(looked_at.nodes, testing::ElementsAre("/camera"));
  EXPECT_EQ(ask("get /api/component", {{"name", "lidar"}}).body["process"], nullptr);
  EXPECT_EQ(ask("get /api/component", {{"name", "nobody"}}).status, 404);
  EXPECT_EQ(ask("get /api/component").status, 400);
}

TEST_F(Routes, DrawTheRobotOnItsMap) {
  link::MapPicture picture;
  picture.topics = {"/map"};
  picture.topic = "/map";
  picture.number = 7;
  picture.grid = link::GridPicture{2, 1, 0.05, 1, {{-1, 2, 0}, {}}, "0?"};
  picture.robots = {{"base_link", {1.23456, 2}, 0.5, std::chrono::milliseconds(250)}};
  picture.path = {"/plan", {{0, 0}, {1, 1}}, {}};
  map = picture;
  const Json drawn = ask("get /api/map", {{"topic", "/map"}, {"known", "6"}}).body;
  EXPECT_EQ(map_asked, std::pair(std::string("/map"), std::uint64_t{6}));
  EXPECT_EQ(drawn["grid"]["cells"], "0?");
  EXPECT_EQ(drawn["grid"]["origin"], Json({-1.0, 2.0, 0.0}));
  EXPECT_EQ(drawn["robots"][0]["at"], Json({1.235, 2.0}));
  EXPECT_EQ(drawn["robots"][0]["age"], 0.25);
  EXPECT_EQ(drawn["path"]["points"], Json({{0.0, 0.0}, {1.0, 1.0}}));
  EXPECT_EQ(drawn["scan"], nullptr);

  EXPECT_EQ(ask("get /api/map", {{"known", "-1"}}).status, 200);
  EXPECT_EQ(map_asked, std::pair(std::string(), std::uint64_t{0}));
  map = Error{"the domain cannot be joined"};
  EXPECT_EQ(ask("get /api/map").status, 503);
}

TEST_F(Routes, ExamineTheRobotForAsLongAsOneAsks) {
  EXPECT_EQ(ask("post /api/doctor", {{"seconds", 2}}).status, 200);
  EXPECT_EQ(examined_for, std::chrono::seconds(2));
  for (const Json& wrong : {Json{{"seconds", 0}}, Json{{"seconds", 1e9}}, Json{{"seconds", "2"}}})
    EXPECT_EQ(ask("post /api/doctor", wrong).status, 400) << wrong;
}

TEST_F(Routes, LookBackOnlyWithRulesThatAreRight) {
  EXPECT_EQ(ask("post /api/rules/replay", {{"text", "RUEL X\n"}, {"seconds", 60}}).status, 422);
  const http::Answer none = ask("post /api/rules/replay", {{"text", kRouteRules}, {"seconds", 60}});
  EXPECT_EQ(none.status, 404);
  EXPECT_EQ(none.body["error"], "nothing is recorded here");
  EXPECT_EQ(ask("post /api/rules/replay", {{"text", kRouteRules}, {"seconds", 1e9}}).status, 400);
}

}  // namespace
}  // namespace culprit::web
