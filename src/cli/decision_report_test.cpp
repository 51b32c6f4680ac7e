// culprit explain: what a decision of a journal hinges on.
#include "cli/decision_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_expected.h"
#include "base/test_folder.h"
#include "journal/session.h"
#include "journal/writer.h"

namespace culprit::cli {
namespace {

using culprit::test::TestFolder;
using culprit::test::value_of;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kReportedAt = 1'800'000'000'000'000'000;  // ns since 1970

std::string explained(const std::string& evidence,
                      const std::string& candidates = R"({"strategy":"s","cost":0.5})") {
  const TestFolder folder;
  journal::Batch rows;
  rows.entries.push_back(
      {0, kReportedAt, std::string(journal::kind::kEvent),
       R"({"type":"strategy_chosen","rule":"R","strategy":"s","text":"camera is responsible","time":1,)"
       R"("suspects":[{"component":"camera","failure":"R","probability":0.9,"evidence":[)" +
           evidence + R"(]}],"candidates":[)" + candidates + "]}"});
  auto writer = value_of(journal::Writer::open(folder / "a.journal", {}));
  const auto done = writer.append(rows, kReportedAt, journal::Durability::kProcessEnd);
  EXPECT_TRUE(done) << done.error();
  return value_of(explain_decision(value_of(journal::Reader::open(folder / "a.journal")), 0));
}

TEST(DecisionReport, SaysWhatWouldChangeIt) {
  const std::string out =
      explained(R"({"source":"kernel","text":"camera exited","log_odds":2.9,"without":"fusion"})");
  EXPECT_THAT(out, HasSubstr("\nWhat would change this\n"
                             "  without \"camera exited\", fusion would be held responsible\n"));
}

TEST(DecisionReport, SaysNothingOfItWhereNothingWould) {
  const std::string out = explained(R"({"source":"kernel","text":"camera exited","log_odds":2.9})");
  EXPECT_THAT(out, HasSubstr("camera exited (kernel, +2.9)"));
  EXPECT_THAT(out, Not(HasSubstr("What would change")));
}

TEST(DecisionReport, SaysWhatWasAskedAndAnswered) {
  const std::string out = explained(
      R"({"source":"kernel","text":"camera exited","age_ns":1200000000,"log_odds":2.9},)"
      R"({"source":"answer","text":"fusion answered","age_ns":200000000,"log_odds":0.0})");
  EXPECT_THAT(out, HasSubstr("camera exited, for 1.20 s (kernel, +2.9)\n\n"
                             "Asked and answered\n"
                             "  fusion answered, 0.20 s before the decision\n"));
}

// 90 % in the file, and "resolves it with 92 %": the restart, which is ruled out, would have fixed the rest.
TEST(DecisionReport, SaysTheSuccessRateBesideTheProbabilityOfTheDecision) {
  const TestFolder folder;
  journal::Session session;
  session.rules_path = "camera.rules";
  session.rules_text = R"(
COMPONENT camera NODE /camera
RULE CameraDead
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY replace 90 10
      ADAPTATION camera redeploy 3
    STRATEGY again 50 10
      ADAPTATION camera restart 3
)";
  session.planner = Json::object();
  const std::string decision =
      R"({"type":"strategy_chosen","rule":"CameraDead","strategy":"replace","text":"it is","candidates":[)"
      R"({"strategy":"replace","cost":1.3,"resolves":0.923,"value":3.7},)"
      R"({"strategy":"again","cost":0,"because":"it is not possible"}]})";
  journal::Batch rows;
  const auto add = [&](std::string_view kind, std::string body) {
    rows.entries.push_back({0, kReportedAt, std::string(kind), std::move(body)});
  };
  add(journal::kind::kSession, to_line(journal::to_json(session)));
  add(journal::kind::kEvent, decision);
  add(journal::kind::kBelief,
      R"({"rule":"CameraDead","strategy":"replace","alpha":9,"beta":6,"prior":[9,1]})");
  add(journal::kind::kEvent, decision);
  auto writer = value_of(journal::Writer::open(folder / "a.journal", {}));
  const auto done = writer.append(rows, kReportedAt, journal::Durability::kProcessEnd);
  ASSERT_TRUE(done) << done.error();
  const auto reader = value_of(journal::Reader::open(folder / "a.journal"));
  EXPECT_THAT(value_of(explain_decision(reader, 2)),
              AllOf(HasSubstr("resolves it with 92 % (success rate 90 %), relative value 3.70"),
                    HasSubstr("strategies that are ruled out make it more likely")));
  EXPECT_THAT(value_of(explain_decision(reader, 4)),
              HasSubstr("resolves it with 92 % (success rate 60 %; the file says 90 %), "));
}

TEST(DecisionReport, SaysOnceWhatWouldEndTheWait) {
  const std::string waits =
      R"("excluded":"suspect","because":"it depends on camera","ends":"if camera does not answer)"
      R"( within 0.60 s, camera is held responsible"})";
  const std::string out =
      explained(R"({"source":"kernel","text":"camera exited","log_odds":2.9,"without":"fusion"})",
                R"({"strategy":"s",)" + waits + R"(,{"strategy":"t",)" + waits);
  EXPECT_THAT(out, HasSubstr("\n  without \"camera exited\", fusion would be held responsible\n"
                             "  if camera does not answer within 0.60 s, camera is held "
                             "responsible\n\nStrategies compared\n"));
}

}  // namespace
}  // namespace culprit::cli
