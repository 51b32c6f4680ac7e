// The words of intents on disk.
#include "journal/requests.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::journal {
namespace {

constexpr const char* kRulesOfRequests = R"(
COMPONENT camera NODE /camera
RULE R
  POLICIES ERROR
  TRIGGER age(/rgb) > 1s
    STRATEGY s 90 10
      ADAPTATION camera restart 1
)";

Command command_of(decltype(Command::what) what, decltype(Reply::value) before = {}) {
  return {.id = {7},
          .component = ComponentId(0),
          .what = std::move(what),
          .timeout = {},
          .purpose = {.strategy = StrategyId(0), .before = std::move(before)}};
}

// The next culprit finishes what it reads there, and it may be a newer one.
TEST(Requests, IntentsAreAsTheyHaveAlwaysBeen) {
  const RuleSet rules = *check(Source("test", kRulesOfRequests)).rules;
  struct Case {
    Command command;
    const char* request;
    const char* before;
    const char* text;
  };
  const Case cases[] = {
      {command_of(ChangeLifecycle{Transition::kDeactivate}, Lifecycle::kActive),
       R"({"change_lifecycle":"deactivate"})", R"({"lifecycle":"active"})", "deactivate"},
      {command_of(SetParameter{"gain", 0.5}, Value(1.0)),
       R"({"set_parameter":{"name":"gain","value":0.5}})", "1.0", "set gain to 0.5"},
      {command_of(SetParameter{"level", std::int64_t{-3}}, Value(true)),
       R"({"set_parameter":{"name":"level","value":-3}})", "true", "set level to -3"},
      {command_of(SetParameter{"mode", "a \"b\""}),
       R"({"set_parameter":{"name":"mode","value":"a \"b\""}})", "null",
       R"(set mode to \"a \\\"b\\\"\")"},
      {command_of(CallService{"reset"}), R"({"call_service":"reset"})", "null", "call reset"},
      {command_of(ChangeMode{"low"}), R"({"change_mode":"low"})", "null", "change mode to low"},
      {command_of(StopProcess{42}), R"({"stop_process":42})", "null", "stop process"},
      {command_of(StartProcess{}), R"({"start_process":null})", "null", "start process"},
  };
  for (const Case& each : cases) {
    const std::string line = line_of(each.command, rules);
    EXPECT_EQ(line, std::string(R"({"command":7,"component":"camera","request":)") + each.request +
                        R"(,"rule":"R","strategy":"s","adaptation":0,"undoes":false,"before":)" +
                        each.before + R"(,"text":"camera: )" + each.text + "\"}");
    const auto again = command_from_json(parse_json(line), rules);
    ASSERT_TRUE(again) << line;
    EXPECT_EQ(line_of(*again, rules), line);
  }
  const Command typed = command_of(CallService{"reset", "{deep: true}"});
  EXPECT_NE(line_of(typed, rules).find(R"({"service":"reset","request":"{deep: true}"})"),
            std::string::npos);
}

}  // namespace
}  // namespace culprit::journal
