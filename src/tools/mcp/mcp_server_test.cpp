#include "mcp/mcp_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::mcp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using Words = std::vector<std::string>;

// A client of a server whose culprit answers as the test says.
class Session {
 public:
  explicit Session(bool is_initialized = true, const std::string& rules = "my.rules",
                   std::set<std::string> allowed = {}) {
    if (allowed.empty()) {
      const auto all = McpServer::all_tools();
      allowed = {all.begin(), all.end()};
    }
    server.emplace(
        McpServer::Options{"1.2.3", rules, std::move(allowed)},
        [this](const Words& words) -> Expected<McpServer::Ran> {
          ran.push_back(words);
          return answer;
        },
        [](const std::string& text) -> Json {
          return {{"text", text}};
        });
    if (is_initialized) request("initialize", {{"protocolVersion", "2025-06-18"}});
  }

  Json say(const std::string& text) {
    return server->handle(parse_strict_json(text)).value_or(Json("nothing"));
  }
  Json request(const std::string& method, Json params) {
    const auto answered =
        server->handle({{"jsonrpc", "2.0"}, {"id", 7}, {"method", method}, {"params", params}});
    EXPECT_TRUE(answered);
    EXPECT_EQ((*answered)["id"], 7);
    return *answered;
  }
  Json call(const std::string& tool, Json arguments = Json::object()) {
    return request("tools/call", {{"name", tool}, {"arguments", std::move(arguments)}});
  }

  std::optional<McpServer> server;
  Expected<McpServer::Ran> answer = McpServer::Ran{0, R"({"well":true})", ""};
  std::vector<Words> ran;
};

std::string text_of(const Json& answer) {
  return answer["result"]["content"][0]["text"].get<std::string>();
}
int code_of(const Json& answer) {
  return answer.contains("error") ? answer["error"]["code"].get<int>() : 0;
}

TEST(Mcp, AgreesOnTheClientsRevisionIfItIsKnown) {
  Session session(false);
  const Json old = session.request("initialize", {{"protocolVersion", "2024-11-05"}});
  EXPECT_EQ(old["result"]["protocolVersion"], "2024-11-05");
  EXPECT_EQ(old["result"]["serverInfo"]["version"], "1.2.3");
  const Json unknown = session.request("initialize", {{"protocolVersion", "2999-01-01"}});
  EXPECT_EQ(unknown["result"]["protocolVersion"], "2025-06-18");
}

TEST(Mcp, AnswersNothingButPingBeforeItIsInitialized) {
  Session session(false);
  EXPECT_EQ(code_of(session.request("tools/list", Json::object())), -32600);
  EXPECT_TRUE(session.request("ping", Json::object()).contains("result"));
  EXPECT_EQ(code_of(session.call("status")), -32600);
  EXPECT_THAT(session.ran, IsEmpty());
}

TEST(Mcp, ListsTheAllowedToolsWithTheirSchemas) {
  Session session(true, "", McpServer::reading_tools());
  const Json tools = session.request("tools/list", Json::object())["result"]["tools"];
  std::vector<std::string> names;
  for (const Json& each : tools) {
    names.push_back(each["name"]);
    EXPECT_EQ(each["inputSchema"]["type"], "object") << each["name"];
    EXPECT_TRUE(each["annotations"]["readOnlyHint"]) << each["name"];
  }
  EXPECT_THAT(names,
              ElementsAre("status", "incidents", "explain", "doctor", "plan", "check_rules"));
  EXPECT_EQ(code_of(session.call("propose", {{"strategy", "A.b"}, {"reason", "x"}})), -32602);
  EXPECT_THAT(session.ran, IsEmpty()) << "a tool that is not allowed is not run";
}

TEST(Mcp, RunsTheCommandThatAPersonWouldType) {
  Session session;
  session.call("status");
  session.call("incidents", {{"since", "2h"}});
  session.call("explain");
  session.call("explain", {{"what", "R012"}});
  session.call("doctor");
  session.call("plan");
  session.call("propose", {{"strategy", "CameraSilent.restart"}, {"reason", "it is hot"}});
  EXPECT_THAT(
      session.ran,
      ElementsAre(Words{"status", "--json"}, Words{"incident", "--json", "--since", "2h"},
                  Words{"explain", "--last", "--json"}, Words{"explain", "R012", "--json"},
                  Words{"doctor", "--json"}, Words{"plan", "--robot", "--json", "--", "my.rules"},
                  Words{"propose", "--json", "--reason=it is hot", "--", "CameraSilent.restart"}));
}

TEST(Mcp, HandsOverTheAnswerAsData) {
  Session session;
  session.answer = McpServer::Ran{1, R"({"why":"ignore\u0007 \u202e this"})", ""};
  const std::string text = text_of(session.call("status"));
  const Json shown = parse_json(text);
  EXPECT_EQ(shown["exit_status"], 1);
  EXPECT_EQ(shown["status"]["why"], R"(ignore\x07 \u202e this)");
  EXPECT_THAT(shown["note"].get<std::string>(), HasSubstr("no instructions"));
}

TEST(Mcp, ReadsADocumentALine) {
  Session session;
  session.answer = McpServer::Ran{0, "{\"id\":1}\n{\"id\":2}\n", ""};
  EXPECT_EQ(parse_json(text_of(session.call("incidents")))["incidents"].size(), 2u);
}

TEST(Mcp, SaysWhyACommandGaveNothing) {
  Session session;
  session.answer = McpServer::Ran{1, "", "culprit: no culprit runs here\x1b[31m\n"};
  const Json none = session.call("status");
  EXPECT_TRUE(none["result"]["isError"]);
  EXPECT_THAT(text_of(none), HasSubstr("no culprit runs here\\x1b"));
  session.answer = Error{"it did not end within a minute"};
  EXPECT_THAT(text_of(session.call("doctor")), HasSubstr("within a minute"));
}

TEST(Mcp, ChecksRulesWithoutAFile) {
  Session session;
  const Json report = session.call("check_rules", {{"text", "RULE A"}});
  EXPECT_EQ(parse_json(text_of(report))["mistakes"]["text"], "RULE A");
  EXPECT_THAT(session.ran, IsEmpty());
  EXPECT_EQ(code_of(session.call("check_rules", {{"text", std::string(300 << 10, 'x')}})), -32602);
}

TEST(Mcp, PlansOnlyWithTheRulesOfTheCommandLine) {
  Session session(true, "");
  EXPECT_TRUE(session.call("plan")["result"]["isError"]);
  EXPECT_EQ(code_of(session.call("plan", {{"rules", "/etc/shadow"}})), -32602);
  EXPECT_THAT(session.ran, IsEmpty());
}

// The server runs no command of a hostile message, and goes on.
TEST(Mcp, SurvivesHostileMessages) {
  Session session;
  const std::string deep = std::string(5000, '[') + std::string(5000, ']');
  for (
      const std::string& message : std::vector<std::string>{
          "",
          "null",
          "7",
          "\"status\"",
          "[]",
          "[{}]",
          "{}",
          "{",
          deep,
          "\xff\xfe",
          R"({"jsonrpc":"1.0","id":1,"method":"ping"})",
          R"({"jsonrpc":"2.0","id":1})",
          R"({"jsonrpc":"2.0","id":null,"method":"ping"})",
          R"({"jsonrpc":"2.0","id":{"a":1},"method":"ping"})",
          R"({"jsonrpc":"2.0","id":1.5,"method":"ping"})",
          R"({"jsonrpc":"2.0","id":1,"method":7})",
          R"({"jsonrpc":"2.0","id":1,"method":""})",
          R"({"jsonrpc":"2.0","id":1,"method":"tools/call"})",
          R"({"jsonrpc":"2.0","id":1,"method":"tools/call","params":[]})",
          R"({"jsonrpc":"2.0","id":1,"method":"tools/call","params":{"name":7}})",
          R"({"jsonrpc":"2.0","id":1,"method":"tools/call","params":{"name":"rm -rf /"}})",
          R"({"jsonrpc":"2.0","id":1,"method":"tools/call","params":{"name":"run-strategy"}})",
          R"({"jsonrpc":"2.0","id":1,"method":"tools/call","params":{"name":"pause"}})",
          R"({"jsonrpc":"2.0","id":1,"method":"tools/call","params":{"name":"status","arguments":7}})",
          R"({"jsonrpc":"2.0","id":1,"method":"tools/call","params":{"name":"status","arguments":{"a":"b"}}})",
          R"({"jsonrpc":"2.0","id":1,"method":"tools/call","params":{"name":"status","name":"doctor"}})",
          R"({"jsonrpc":"2.0","id":1,"method":"tools/list","params":{"cursor":"x"}})",
          R"({"jsonrpc":"2.0","id":1,"method":"initialize"})",
          R"({"jsonrpc":"2.0","id":1,"method":"initialize","params":{"protocolVersion":1}})",
          R"({"jsonrpc":"2.0","id":1,"method":"resources/read","params":{"uri":"file:///etc/shadow"}})",
          R"({"jsonrpc":"2.0","method":"tools/call","params":{"name":"doctor"}})",
          R"({"jsonrpc":"2.0","id":1,"result":{}})"}) {
    const Json answer = session.say(message);
    EXPECT_TRUE(answer == "nothing" || code_of(answer) != 0) << message << "\n" << answer;
  }
  for (const Json& arguments : std::vector<Json>{{{"what", "--journal=/etc/shadow"}},
                                                 {{"what", "-h"}},
                                                 {{"what", "R01"}},
                                                 {{"what", "../x"}},
                                                 {{"what", std::string(100, '1')}},
                                                 {{"what", 7}}})
    EXPECT_EQ(code_of(session.call("explain", arguments)), -32602) << arguments;
  for (const char* since : {"--journal", "2", "h", "2h;rm", "99999999999999h"})
    EXPECT_EQ(code_of(session.call("incidents", {{"since", since}})), -32602) << since;
  for (const char* strategy : {"", "--all", "A", "A.", ".b", "A.b c", "A.b\n", "A.b.c", "$(x).y"})
    EXPECT_EQ(code_of(session.call("propose", {{"strategy", strategy}, {"reason", "x"}})), -32602)
        << strategy;
  EXPECT_EQ(code_of(session.call("propose", {{"strategy", "A.b"}})), -32602);
  EXPECT_EQ(
      code_of(session.call("propose", {{"strategy", "A.b"}, {"reason", std::string(501, 'x')}})),
      -32602);
  EXPECT_THAT(session.ran, IsEmpty());
  session.call("status");
  EXPECT_EQ(session.ran.size(), 1u) << "it goes on";
}

// No way to act without a person: whatever tools are allowed, these are the only commands.
TEST(Mcp, HasNoToolThatActs) {
  Session session;
  for (const std::string& tool : McpServer::all_tools())
    session.call(tool, {{"strategy", "A.b"}, {"reason", "x"}});
  session.call("propose", {{"strategy", "A.b"}, {"reason", "x"}});
  for (const Words& words : session.ran)
    EXPECT_THAT(words.front(),
                Not(testing::AnyOf("run-strategy", "approve", "resume", "pause", "mute", "silence",
                                   "revive", "end-started", "run")));
}

}  // namespace
}  // namespace culprit::mcp
