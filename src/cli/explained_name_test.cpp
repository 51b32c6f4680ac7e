// culprit explain NAME, as a newcomer asks it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "cli/commands.h"
#include "cli/test_command.h"
#include "journal/session.h"
#include "journal/writer.h"

namespace culprit::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kNamedRules = R"(
COMPONENT camera NODE /camera
COMPONENT fusion NODE /fusion
RULE CameraDark
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY brighten 90 10
      ADAPTATION camera restart 3
RULE MapOld
  POLICIES WARNING
  TRIGGER age(/map) > 1s
    STRATEGY reload 50 10
      ADAPTATION fusion restart 3
)";

struct ExplainName : testing::Test {
  ExplainName() {
    journal::Session session;
    session.rules_path = "named.rules";
    session.rules_text = kNamedRules;
    session.planner = Json::object();
    journal::Batch rows;
    rows.entries.push_back(
        {0, 1, std::string(journal::kind::kSession), to_line(journal::to_json(session))});
    for (const char* text : {"an older decision", "camera is held responsible"})
      rows.entries.push_back(
          {0, 1, std::string(journal::kind::kEvent),
           to_line({{"type", "strategy_chosen"}, {"rule", "CameraDark"}, {"text", text}})});
    auto writer = journal::Writer::open(path, {});
    EXPECT_TRUE(writer) << writer.error();
    EXPECT_TRUE(writer->append(rows, 1, journal::Durability::kPowerFailure));
  }
  CommandEnd explain(const std::string& name, std::vector<std::string> options = {}) const {
    std::vector<std::string> words = {"explain", name, "--journal", path.string()};
    words.insert(words.end(), options.begin(), options.end());
    return end_of_command(add_explain, std::move(words));
  }

  const test::TestFolder own;
  const std::filesystem::path path = own / "a.journal";
};

TEST_F(ExplainName, OfARuleHasItsStrategiesAndItsLatestDecision) {
  const CommandEnd end = explain("CameraDark");
  EXPECT_EQ(end.exit_code, kOk) << end.err;
  EXPECT_THAT(end.out,
              AllOf(HasSubstr("CameraDark is a rule: it detects a failure of level ERROR."),
                    HasSubstr("brighten: restart camera"), HasSubstr("camera is held responsible"),
                    Not(HasSubstr("an older decision"))));
}

TEST_F(ExplainName, OfAComponentOrItsNodeHasTheRulesThatActOnIt) {
  for (const char* name : {"camera", "/camera"}) {
    const CommandEnd end = explain(name);
    EXPECT_EQ(end.exit_code, kOk) << end.err;
    EXPECT_THAT(end.out, AllOf(HasSubstr("camera is a component, the node /camera."),
                               HasSubstr("acted on by CameraDark"),
                               HasSubstr("culprit log --component camera"),
                               HasSubstr("camera is held responsible")));
  }
}

TEST_F(ExplainName, OfAStrategySaysThatNoDecisionWasMade) {
  for (const char* name : {"reload", "MapOld.reload"}) {
    const CommandEnd end = explain(name);
    EXPECT_EQ(end.exit_code, kOk) << end.err;
    EXPECT_THAT(end.out, AllOf(HasSubstr("reload is a strategy of MapOld: restart fusion."),
                               HasSubstr("No decision was made about it yet.")));
  }
}

TEST_F(ExplainName, IsADocumentForPrograms) {
  EXPECT_THAT(explain("CameraDark", {"--json"}).out,
              AllOf(HasSubstr(R"("kind":"rule")"), HasSubstr("camera is held responsible")));
  EXPECT_THAT(explain("reload", {"--json"}).out, HasSubstr(R"("decision":null)"));
}

TEST_F(ExplainName, ThatNobodyKnowsLeadsToTheOneThatWasMeant) {
  const CommandEnd end = explain("CamraDark");
  EXPECT_EQ(end.exit_code, kUsage);
  EXPECT_THAT(end.err, HasSubstr("no code, term, rule, component or strategy 'CamraDark'; did you "
                                 "mean 'CameraDark'?"));
  EXPECT_THAT(explain("mywpiwzf-0k7").err, HasSubstr("culprit incident mywpiwzf-0k7"));
}

}  // namespace
}  // namespace culprit::cli
