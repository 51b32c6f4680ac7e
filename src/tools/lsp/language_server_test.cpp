#include "lsp/language_server.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/test_example_robot.h"
#include "lsp/message_stream.h"
#include "lsp/text_position.h"

namespace culprit::lsp {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kUri = "file:///robot.rules";

// Lines are counted from 0. The umlauts and the emoji make bytes and UTF-16 units differ.
constexpr const char* kText = R"(CONST limit = 0.06
COMPONENT camera NODE /camera LAUNCH "driver"
SIGNAL entropy DIAGNOSTIC segmentation KEY entropy STALE 1s
# Bäume 🌳
RULE Blurred
  POLICIES WARNING
  TRIGGER entropy > limit && age(/image) < 1s
    STRATEGY focus 80 50
      ADAPTATION camera set_parameter autofocus true 2
    STRATEGY relaunch 10 50
      ADAPTATION camera redeploy 5
)";

// An editor with one file open.
class Session {
 public:
  explicit Session(const std::string& text = kText) {
    request("initialize", {{"capabilities", Json::object()}});
    notify("initialized", Json::object());
    notify("textDocument/didOpen",
           {{"textDocument", {{"uri", kUri}, {"version", 1}, {"text", text}}}});
  }

  Json request(const std::string& method, Json params) {
    const int id = ++last_id_;
    server.handle(
        {{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", std::move(params)}});
    EXPECT_FALSE(sent.empty());
    EXPECT_EQ(sent.back()["id"], id);
    return sent.back();
  }
  void notify(const std::string& method, Json params) {
    server.handle({{"jsonrpc", "2.0"}, {"method", method}, {"params", std::move(params)}});
  }
  Json ask(const std::string& what, std::uint32_t line, std::uint32_t character, Json more = {}) {
    Json params{{"textDocument", {{"uri", kUri}}},
                {"position", {{"line", line}, {"character", character}}}};
    if (more.is_object()) params.update(more);
    return request("textDocument/" + what, params);
  }
  Json diagnostics() const {
    Json last;
    for (const Json& message : sent) {
      if (message.value("method", "") == "textDocument/publishDiagnostics")
        last = message["params"]["diagnostics"];
    }
    return last;
  }
  void change(const std::string& text) {
    notify("textDocument/didChange",
           {{"textDocument", {{"uri", kUri}}}, {"contentChanges", {{{"text", text}}}}});
  }

  std::vector<Json> sent;
  LanguageServer server{"1.0", [this](const Json& message) { sent.push_back(message); }};

 private:
  int last_id_ = 0;
};

std::vector<std::string> labels(const Json& reply) {
  std::vector<std::string> out;
  for (const Json& item : reply["result"]) out.push_back(item["label"]);
  return out;
}

TEST(LspServer, SaysWhatItCanDo) {
  Session session;
  const Json reply = session.request("initialize", Json::object());
  EXPECT_EQ(reply["result"]["serverInfo"]["name"], "culprit");
  EXPECT_TRUE(reply["result"]["capabilities"]["hoverProvider"]);
}

TEST(LspServer, ReportsMistakesAsTheyAreTypedAndTakesThemBack) {
  Session session;
  EXPECT_EQ(session.diagnostics(), Json::array());
  session.change("COMPONENT camera NODE /camera\nRULE r\n  POLICIES EROR\n");
  const Json mistakes = session.diagnostics();
  ASSERT_FALSE(mistakes.empty());
  EXPECT_EQ(mistakes[0]["range"]["start"]["line"], 2);
  EXPECT_EQ(mistakes[0]["range"]["start"]["character"], 11);
  EXPECT_THAT(mistakes[0]["message"].get<std::string>(), HasSubstr("ERROR"));
  session.change(kText);
  EXPECT_EQ(session.diagnostics(), Json::array());
}

TEST(LspServer, GoesToDefinitionsAndFindsUses) {
  Session session;
  const Json definition = session.ask("definition", 6, 12);  // entropy in the trigger
  EXPECT_EQ(definition["result"]["range"]["start"], (Json{{"line", 2}, {"character", 7}}));
  const Json uses = session.ask("references", 1, 12);  // camera
  EXPECT_EQ(uses["result"].size(), 3u);
  const Json others =
      session.ask("references", 1, 12, {{"context", {{"includeDeclaration", false}}}});
  EXPECT_EQ(others["result"].size(), 2u);
  EXPECT_TRUE(session.ask("definition", 3, 0)["result"].is_null()) << "a comment";
}

TEST(LspServer, RenamesEveryUse) {
  Session session;
  const Json reply = session.ask("rename", 0, 6, {{"newName", "threshold"}});
  const Json edits = reply["result"]["changes"][kUri];
  ASSERT_EQ(edits.size(), 2u);
  EXPECT_EQ(edits[1]["range"]["start"], (Json{{"line", 6}, {"character", 20}}));
  EXPECT_EQ(edits[1]["newText"], "threshold");

  EXPECT_TRUE(session.ask("rename", 0, 6, {{"newName", "two words"}}).contains("error"));
  EXPECT_TRUE(session.ask("rename", 0, 6, {{"newName", "camera"}}).contains("error"));
  EXPECT_TRUE(session.ask("rename", 6, 35, {{"newName", "x"}}).contains("error")) << "a topic";
}

TEST(LspServer, ShowsWhatThingsAre) {
  Session session;
  const auto hover = [&](std::uint32_t line, std::uint32_t character) {
    return session.ask("hover", line, character)["result"]["contents"]["value"].get<std::string>();
  };
  EXPECT_THAT(hover(6, 12), HasSubstr("Unknown when older than 1s"));
  EXPECT_THAT(hover(6, 30), HasSubstr("age(topic)"));
  EXPECT_THAT(hover(8, 18), HasSubstr("Adapted by focus, relaunch"));
  EXPECT_THAT(hover(6, 22), HasSubstr("CONST limit = 0.06"));
}

TEST(LspServer, ProposesWhatFitsThePlace) {
  Session session(std::string(kText) +
                  "\n  TRIGGER \n      ADAPTATION \n      ADAPTATION camera \n"
                  "  POLICIES \n  TRIGGER age(\n  TRIGGER alive(\n"
                  "COMPONENT a \nCOMPONENT a UNIT \nCOMPONENT a UNIT a.service \n");
  EXPECT_THAT(labels(session.ask("completion", 18, 12)), Contains("UNIT"));
  EXPECT_THAT(labels(session.ask("completion", 19, 17)), testing::IsEmpty());
  EXPECT_THAT(labels(session.ask("completion", 20, 27)), Contains("USER"));
  EXPECT_THAT(labels(session.ask("completion", 11, 0)), Contains("RULE"));
  EXPECT_THAT(labels(session.ask("completion", 12, 10)), Contains("entropy"));
  EXPECT_THAT(labels(session.ask("completion", 12, 10)), Contains("phi"));
  EXPECT_THAT(labels(session.ask("completion", 13, 17)), testing::ElementsAre("camera", "a"));
  EXPECT_THAT(labels(session.ask("completion", 14, 24)), Contains("redeploy"));
  EXPECT_THAT(labels(session.ask("completion", 15, 11)), Contains("WARNING"));
  EXPECT_THAT(labels(session.ask("completion", 16, 14)), testing::ElementsAre("/image"));
  EXPECT_THAT(labels(session.ask("completion", 17, 16)), testing::ElementsAre("camera", "a"));
}

TEST(LspServer, LaysOutTheFile) {
  Session session(
      "RULE r\nPOLICIES   ERROR\nTRIGGER age(/t)>1s\nSTRATEGY s 50 10\nADAPTATION c restart 5\n");
  const auto format = [&] {
    return session.request("textDocument/formatting",
                           {{"textDocument", {{"uri", kUri}}}})["result"];
  };
  const Json edits = format();
  ASSERT_EQ(edits.size(), 1u);
  EXPECT_THAT(edits[0]["newText"].get<std::string>(), HasSubstr("\n  TRIGGER age(/t) > 1s\n"));
  session.change(edits[0]["newText"]);
  EXPECT_EQ(format(), Json::array()) << "it is laid out already";
  session.change("RULE\n");
  EXPECT_EQ(format(), Json::array()) << "what does not parse is left alone";
}

TEST(LspServer, OffersTheFixOfWhatIsPointedAt) {
  Session session("ROBOT r\n# Bäume 🌳\nrobot x\nCONTS a = 3\nCYCLE 200\n");
  const auto actions = [&](std::uint32_t line, Json context = Json::object()) {
    const Json place{{"line", line}, {"character", 0}};
    return session.request("textDocument/codeAction",
                           {{"textDocument", {{"uri", kUri}}},
                            {"range", {{"start", place}, {"end", place}}},
                            {"context", std::move(context)}})["result"];
  };
  EXPECT_EQ(actions(0), Json::array());
  EXPECT_EQ(actions(4), Json::array()) << "which unit is meant is not known";
  ASSERT_EQ(actions(3).size(), 1u);
  const Json action = actions(3)[0];
  EXPECT_EQ(action["title"], "change 'CONTS' to 'CONST'");
  EXPECT_EQ(action["isPreferred"], true);
  EXPECT_EQ(action["diagnostics"][0]["code"], "R001");
  const Json edit = action["edit"]["changes"][kUri][0];
  EXPECT_EQ(edit["newText"], "CONST");
  EXPECT_EQ(edit["range"]["start"], (Json{{"line", 3}, {"character", 0}}));
  EXPECT_EQ(edit["range"]["end"], (Json{{"line", 3}, {"character", 5}}));
  EXPECT_EQ(actions(3, {{"only", {"refactor"}}}), Json::array());
  EXPECT_EQ(actions(3, {{"only", {"quickfix"}}}).size(), 1u);
}

TEST(LspServer, PrefersNoFixWhereThereIsAChoice) {
  Session session("robot x\nCONTS a = 3\n");
  const Json actions = session.request("textDocument/codeAction",
                                       {{"textDocument", {{"uri", kUri}}},
                                        {"range",
                                         {{"start", {{"line", 0}, {"character", 0}}},
                                          {"end", {{"line", 9u}, {"character", 0u}}}}}})["result"];
  ASSERT_EQ(actions.size(), 2u);
  EXPECT_FALSE(actions[0].contains("isPreferred"));
}

// The robot of test_example_robot.h, with a topic that is watched.
LiveInventory robot() {
  LiveInventory robot = example_robot();
  robot.topics["/robot/image"].rate = 29.96;
  robot.topics["/robot/image"].fields["width"] = Value(std::int64_t{640});
  return robot;
}

TEST(LspServer, SaysWhatTheRobotHasNotAndTakesItBack) {
  Session session("COMPONENT camera NODE /camera\n");
  EXPECT_EQ(session.diagnostics(), Json::array()) << "no robot was seen";
  session.server.see({});
  EXPECT_EQ(session.diagnostics(), Json::array()) << "a robot that is not there says nothing";

  session.server.see(robot());
  ASSERT_EQ(session.diagnostics().size(), 1u);
  EXPECT_EQ(session.diagnostics()[0]["code"], "R060");
  EXPECT_EQ(session.diagnostics()[0]["severity"], 2);

  const std::size_t sent = session.sent.size();
  session.server.see(robot());
  EXPECT_EQ(session.sent.size(), sent) << "nothing has changed";

  session.change("COMPONENT camera NODE /robot/camera\n");
  EXPECT_EQ(session.diagnostics(), Json::array());
  session.change("COMPONENT camera NODE /camera\n");
  EXPECT_EQ(session.diagnostics().size(), 1u);
  LiveInventory with_camera = robot();
  with_camera.nodes["/camera"];
  session.server.see(with_camera);
  EXPECT_EQ(session.diagnostics(), Json::array()) << "it was started meanwhile";
}

TEST(LspServer, ProposesWhatTheRobotHas) {
  Session session(
      "COMPONENT cam NODE /robot/camera\nCOMPONENT x NODE \nSIGNAL s TOPIC /rob\n"
      "SIGNAL s DIAGNOSTIC camera KEY \nSIGNAL s PARAMETER cam \n  TRIGGER rate(\n"
      "  TRIGGER parameter(cam, \n  TRIGGER level(\n      ADAPTATION \n"
      "      ADAPTATION cam set_parameter \n      ADAPTATION cam call \n"
      "      ADAPTATION cam change_communication exposure \n");
  const auto offers = [&](std::uint32_t line) {
    return labels(session.ask("completion", line, 1000));
  };
  EXPECT_THAT(offers(1), testing::IsEmpty()) << "no robot was seen";
  session.server.see(robot());
  EXPECT_THAT(offers(1), testing::ElementsAre("/left/arm", "/left/wheel", "/right/arm",
                                              "/right/wheel", "/robot/camera"));
  EXPECT_THAT(offers(2), Contains("/robot/image"));
  EXPECT_THAT(offers(3), testing::ElementsAre("entropy"));
  EXPECT_THAT(offers(4), testing::ElementsAre("exposure"));
  EXPECT_THAT(offers(5), Contains("/robot/image"));
  EXPECT_THAT(offers(6), testing::ElementsAre("exposure"));
  EXPECT_THAT(offers(7), testing::ElementsAre("camera"));
  EXPECT_THAT(offers(8), testing::IsSupersetOf({"cam", "/robot/camera"}));
  EXPECT_THAT(offers(9), testing::ElementsAre("exposure"));
  EXPECT_THAT(offers(10), testing::ElementsAre("/robot/camera/light", "/robot/camera/recalibrate"));
  EXPECT_THAT(offers(11), Contains("/robot/image"));
}

TEST(LspServer, ReplacesWhatIsTypedOfAName) {
  Session session("SIGNAL s TOPIC /robot/im\n  TRIGGER rate(/robot/image)>rat\n");
  session.server.see(robot());
  const auto edit = [&](std::uint32_t line, const std::string& label) {
    const Json reply = session.ask("completion", line, 1000);
    for (const Json& item : reply["result"]) {
      if (item["label"] == label) return item["textEdit"]["range"];
    }
    return Json();
  };
  EXPECT_EQ(edit(0, "/robot/image")["start"], (Json{{"line", 0}, {"character", 15}}));
  EXPECT_EQ(edit(1, "rate")["start"], (Json{{"line", 1}, {"character", 29}}));
}

TEST(LspServer, ShowsWhatThingsAreNow) {
  Session session(
      "COMPONENT camera NODE /robot/camera\nCOMPONENT gone NODE /gone\n"
      "SIGNAL entropy DIAGNOSTIC camera KEY entropy\nSIGNAL width TOPIC /robot/image FIELD width\n"
      "SIGNAL exposure PARAMETER camera exposure\n"
      "RULE r\n  POLICIES ERROR\n  TRIGGER entropy + width + exposure > level(camera)\n"
      "    STRATEGY s 50 10\n      ADAPTATION camera call recalibrate 2\n");
  session.server.see(robot());
  const auto hover = [&](std::uint32_t line, std::uint32_t character) {
    return session.ask("hover", line, character)["result"]["contents"]["value"].get<std::string>();
  };
  EXPECT_THAT(hover(0, 12), HasSubstr("On the robot as `/robot/camera`, active."));
  EXPECT_THAT(hover(1, 12), HasSubstr("Not on the robot now."));
  EXPECT_THAT(hover(7, 12), HasSubstr("Now `0.03`."));
  EXPECT_THAT(hover(7, 22), HasSubstr("Now `640`."));
  EXPECT_THAT(hover(7, 30), HasSubstr("Now `0.5`."));
  EXPECT_THAT(hover(3, 25), HasSubstr("`sensor_msgs/msg/Image`, 30.0 Hz now."));
  EXPECT_THAT(hover(4, 35), HasSubstr("Now `0.5`."));
  EXPECT_THAT(hover(2, 28), HasSubstr("Level 0 (OK) now."));
  EXPECT_THAT(hover(9, 32), HasSubstr("std_srvs/srv/Trigger"));
}

TEST(LspServer, AsksForWhatTheDocumentsName) {
  Session session("COMPONENT camera NODE /robot/camera\nSIGNAL w TOPIC /robot/image FIELD width\n");
  const LiveInterest wanted{{"/robot/camera"}, {{"/robot/image", {"width"}}}};
  EXPECT_EQ(session.server.interest(), wanted);
  session.change("COMPONENT camera NODE\n");
  EXPECT_EQ(session.server.interest(), wanted) << "while a line is being typed";
  session.notify("textDocument/didClose", {{"textDocument", {{"uri", kUri}}}});
  EXPECT_EQ(session.server.interest(), LiveInterest{});
}

TEST(LspServer, OutlinesTheFile) {
  Session session;
  const Json symbols =
      session.request("textDocument/documentSymbol", {{"textDocument", {{"uri", kUri}}}})["result"];
  ASSERT_EQ(symbols.size(), 4u);
  EXPECT_EQ(symbols[3]["name"], "Blurred");
  ASSERT_EQ(symbols[3]["children"].size(), 2u);
  EXPECT_EQ(symbols[3]["children"][1]["name"], "relaunch");
  EXPECT_EQ(symbols[3]["range"]["end"]["line"], 9);
}

TEST(LspServer, ColoursNames) {
  Session session;
  const Json data = session.request("textDocument/semanticTokens/full",
                                    {{"textDocument", {{"uri", kUri}}}})["result"]["data"];
  ASSERT_EQ(data.size() % 5, 0u);
  // `limit` is declared on the first line at 6, five characters long.
  EXPECT_EQ(Json(data.begin(), data.begin() + 5), Json({0, 6, 5, 0, 1}));
}

TEST(LspServer, AnswersEveryRequestWhateverItIs) {
  Session session;
  EXPECT_EQ(session.request("textDocument/nonsense",
                            {{"textDocument", {{"uri", kUri}}}})["error"]["code"],
            -32601);
  EXPECT_TRUE(session.request("textDocument/hover", Json::array({1, 2}))["error"].is_object());
  EXPECT_TRUE(
      session.request("textDocument/hover", {{"textDocument", {{"uri", 7}}}})["error"].is_object());
  EXPECT_TRUE(session.ask("hover", 4'000'000'000u, 4'000'000'000u)["result"].is_null());
  EXPECT_TRUE(session.server.handle(Json(Json::value_t::discarded)));
  EXPECT_EQ(session.sent.back()["error"]["code"], -32700);
  EXPECT_TRUE(session.server.handle(Json::array()));
}

TEST(LspServer, EndsAsTheProtocolWantsIt) {
  Session session;
  EXPECT_EQ(session.server.exit_code(), 1) << "an exit without a shutdown";
  EXPECT_TRUE(session.request("shutdown", nullptr)["result"].is_null());
  EXPECT_TRUE(session.request("textDocument/hover", nullptr).contains("error"));
  EXPECT_FALSE(session.server.handle({{"jsonrpc", "2.0"}, {"method", "exit"}}));
  EXPECT_EQ(session.server.exit_code(), 0);
}

TEST(LspMessages, ComeBackAsTheyWereWritten) {
  std::stringstream stream;
  write_message(stream, {{"text", "Bäume 🌳"}});
  write_message(stream, {{"second", 2}});
  EXPECT_EQ((**read_message(stream))["text"], "Bäume 🌳");
  EXPECT_EQ((**read_message(stream))["second"], 2);
  const auto end = read_message(stream);
  ASSERT_TRUE(end);
  EXPECT_FALSE(*end);
}

// ---- Files that include others

constexpr const char* kDriver = R"(# A driver that falls silent is started again.
TEMPLATE driver(name, topic)
  CONST late = 1s
  RULE {name}_silent
    POLICIES ERROR
    TRIGGER age({topic}) > late
      STRATEGY redeploy 50 10
        ADAPTATION {name} redeploy 5
END
SIGNAL charge TOPIC /battery FIELD percentage
)";
constexpr const char* kDriverUri = "file:///packs/driver.rules";

// An editor with a file open beside a file that it may include.
class ReuseSession {
 public:
  explicit ReuseSession(const std::string& text) { open(kUri, text); }

  void open(const std::string& uri, const std::string& text) {
    server.handle({{"method", "textDocument/didOpen"},
                   {"params", {{"textDocument", {{"uri", uri}, {"text", text}}}}}});
  }
  Json ask(const std::string& what, std::uint32_t line, std::uint32_t character) {
    server.handle({{"id", 1},
                   {"method", "textDocument/" + what},
                   {"params",
                    {{"textDocument", {{"uri", kUri}}},
                     {"position", {{"line", line}, {"character", character}}}}}});
    return sent.back()["result"];
  }
  // The newest of each document, "line: message".
  std::map<std::string, std::vector<std::string>> said() const {
    std::map<std::string, std::vector<std::string>> all;
    for (const Json& message : sent) {
      if (message.value("method", "") != "textDocument/publishDiagnostics") continue;
      auto& lines = all[message["params"]["uri"]];
      lines.clear();
      for (const Json& d : message["params"]["diagnostics"])
        lines.push_back(to_line(d["range"]["start"]["line"]) + ": " +
                        d["message"].get<std::string>());
    }
    return all;
  }

  std::string on_disk = kDriver;
  std::vector<Json> sent;
  LanguageServer server{
      "1.0",
      [this](const Json& message) { sent.push_back(message); },
      {[this](const std::string& file, const std::string& from) -> Expected<Source> {
         EXPECT_EQ(from, "/robot.rules");
         if (file != "packs/driver.rules") return Error{"there is no '" + file + "'"};
         return Source("/packs/driver.rules", on_disk);
       },
       [](const std::string&) { return std::vector<std::string>{"packs/driver.rules"}; }}};
};

constexpr const char* kUses =
    "INCLUDE \"packs/driver.rules\"\n"
    "COMPONENT lidar NODE /lidar LAUNCH \"lidar\"\n"
    "USE driver(lidar, /scan)\n"
    "INTERLOCK charge > 0.1\n";

TEST(LspReuse, FindsNothingWrongWithWhatFits) {
  ReuseSession editor(kUses);
  EXPECT_EQ(editor.said()[kUri], std::vector<std::string>());
}

TEST(LspReuse, SaysWhereAnArgumentGoes) {
  ReuseSession editor(
      "INCLUDE \"packs/driver.rules\"\nCOMPONENT lidar LAUNCH \"l\"\n"
      "USE driver(lidra, /scan)\n");
  const auto said = editor.said()[kUri];
  ASSERT_FALSE(said.empty());
  EXPECT_THAT(said, Contains(AllOf(HasSubstr("2: component 'lidra' is not declared"),
                                   HasSubstr("it goes in here: /packs/driver.rules:8"))));
}

TEST(LspReuse, ShowsMistakesInTheFileThatHasThem) {
  ReuseSession editor(kUses);
  editor.open(kDriverUri, "SIGNAL charge TOPIC /battery\n");
  EXPECT_THAT(editor.said()[kDriverUri], ElementsAre(HasSubstr("0: expected FIELD")));
  EXPECT_THAT(editor.said()[kUri], Contains(HasSubstr("0: /packs/driver.rules:1: expected FIELD")));
  // An open document overrides the disk; once it is mended there, all is well.
  editor.open(kDriverUri, kDriver);
  EXPECT_TRUE(editor.said()[kDriverUri].empty());
  EXPECT_TRUE(editor.said()[kUri].empty());
}

TEST(LspReuse, GoesToDefinitionsInOtherFiles) {
  ReuseSession editor(kUses);
  EXPECT_EQ(editor.ask("definition", 0, 12)["uri"], kDriverUri);
  const Json pattern = editor.ask("definition", 2, 6);
  EXPECT_EQ(pattern["uri"], kDriverUri);
  EXPECT_EQ(pattern["range"]["start"]["line"], 1);
  const Json charge = editor.ask("definition", 3, 12);
  EXPECT_EQ(charge["uri"], kDriverUri);
  EXPECT_EQ(charge["range"]["start"]["line"], 9);
}

TEST(LspReuse, TellsWhatATemplateIs) {
  ReuseSession editor(kUses);
  const std::string text = editor.ask("hover", 2, 6)["contents"]["value"];
  EXPECT_THAT(text, HasSubstr("USE driver(name, topic)"));
  EXPECT_THAT(text, HasSubstr("A driver that falls silent is started again."));
  EXPECT_THAT(editor.ask("hover", 3, 12)["contents"]["value"].get<std::string>(),
              AllOf(HasSubstr("SIGNAL charge TOPIC"), HasSubstr("/packs/driver.rules")));
}

std::vector<std::string> labels_of(const Json& items) {
  std::vector<std::string> labels;
  for (const Json& item : items) labels.push_back(item["label"]);
  return labels;
}

TEST(LspReuse, ProposesFilesTemplatesAndParameters) {
  ReuseSession editor(std::string(kUses) +
                      "INCLUDE \nUSE \nTEMPLATE t(node)\n  COMPONENT c NODE \n"
                      "END\n");
  EXPECT_THAT(labels_of(editor.ask("completion", 4, 8)), Contains("\"packs/driver.rules\""));
  editor.open(kUri, std::string(kUses) + "TEMPLATE t(node)\n  COMPONENT c NODE \nEND\nUSE \n");
  EXPECT_THAT(labels_of(editor.ask("completion", 5, 19)), Contains("{node}"));
  editor.open(kUri, std::string(kUses) + "USE d");
  EXPECT_THAT(labels_of(editor.ask("completion", 4, 5)), Contains("driver"));
}

TEST(LspReuse, RenamesAParameterWithItsUses) {
  ReuseSession editor("TEMPLATE t(node)\n  COMPONENT c NODE /{node}/x\nEND\nUSE t(a)\n");
  editor.server.handle({{"id", 1},
                        {"method", "textDocument/rename"},
                        {"params",
                         {{"textDocument", {{"uri", kUri}}},
                          {"position", {{"line", 1u}, {"character", 22u}}},
                          {"newName", "where"}}}});
  EXPECT_EQ(editor.sent.back()["result"]["changes"][kUri].size(), 2u) << editor.sent.back();
}

TEST(LspMessages, RefuseWhatIsNone) {
  const auto reads = [](const std::string& text) {
    std::istringstream stream(text);
    return static_cast<bool>(read_message(stream));
  };
  EXPECT_FALSE(reads("hello\r\n\r\n{}"));
  EXPECT_FALSE(reads("Content-Length: 10\r\n\r\n{}"));
  EXPECT_FALSE(reads("Content-Length: 99999999999999999999\r\n\r\n{}"));
  EXPECT_FALSE(reads("Content-Length: 999999999999\r\n\r\n{}"));
  EXPECT_FALSE(reads("Content-Length: -1\r\n\r\n{}"));
  EXPECT_TRUE(reads("Content-Type: x\r\nContent-Length: 2\r\n\r\n{}"));
  std::istringstream broken("Content-Length: 2\r\n\r\n{]");
  EXPECT_TRUE((*read_message(broken))->is_discarded());
}

TEST(LspPositions, CountInUtf16Units) {
  const Source source("", "aä🌳b\nx");
  EXPECT_EQ(text_position(source, 7), (TextPosition{0, 4}));
  EXPECT_EQ(offset_of(source, {0, 4}), 7u);
  EXPECT_EQ(offset_of(source, {0, 99}), 8u);
  EXPECT_EQ(offset_of(source, {1, 0}), 9u);
  EXPECT_EQ(offset_of(source, {99, 0}), 10u);
  for (const std::uint32_t offset : {0u, 1u, 3u, 7u, 8u, 9u, 10u})
    EXPECT_EQ(offset_of(source, text_position(source, offset)), offset);
}

}  // namespace
}  // namespace culprit::lsp
