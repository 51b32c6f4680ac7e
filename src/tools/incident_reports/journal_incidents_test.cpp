// Lists of incidents from a journal: from events in it, and from a day of them.
#include "incident_reports/journal_incidents.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_expected.h"
#include "base/test_folder.h"
#include "incident_reports/incident_report.h"
#include "journal/session.h"
#include "journal/writer.h"

namespace culprit::incident_reports {
namespace {

using culprit::test::TestFolder;
using culprit::test::value_of;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kTwoRules = R"(
COMPONENT camera NODE /camera
COMPONENT fusion NODE /fusion
RULE CameraDead
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY replace 50 10
      ADAPTATION camera restart 3
RULE FusionSilent
  POLICIES WARNING
  TRIGGER age(/fused) > 1s
    STRATEGY again 50 10
      ADAPTATION fusion restart 3
)";
constexpr double kNoon = 1'800'000'000;  // s since 1970
constexpr std::int64_t kSecond = 1'000'000'000;

// A journal with events at so many seconds after noon. The robot's clock was at 100 s then.
struct JournalIncidents : testing::Test {
  void tell(double after, Json event, const char* text = "something") {
    event["text"] = text;
    event["time"] = static_cast<std::int64_t>((100 + after) * kSecond);
    add(journal::kind::kEvent, after, event);
  }
  void detected(double after, const char* rule, const char* criticality = "ERROR") {
    tell(after, {{"type", "failure_detected"}, {"rule", rule}, {"criticality", criticality}});
  }
  void resolved(double after, const char* rule, const char* strategy = nullptr) {
    Json event{{"type", "failure_resolved"}, {"rule", rule}};
    if (strategy != nullptr) event["strategy"] = strategy;
    tell(after, event);
  }
  void chosen(double after, const char* rule, const char* strategy) {
    tell(after, {{"type", "strategy_chosen"}, {"rule", rule}, {"strategy", strategy}});
  }
  // A manager's event of an incident that began `age` seconds before.
  void incident(double after, const char* type, const char* id, const char* rule,
                const std::vector<std::string>& consequences, const char* component, double age,
                Json more = Json::object()) {
    Json event{{"type", type},
               {"incident", id},
               {"rule", rule},
               {"consequences", consequences},
               {"components", {component}},
               {"certain", true},
               {"criticality", "ERROR"},
               {"age_ns", static_cast<std::int64_t>(age * kSecond)}};
    event.update(more);
    tell(after, event, "");
  }
  void session(double after, std::int64_t wall = 0) {
    journal::Session session;
    session.wall = wall;
    session.rules_path = "two.rules";
    session.rules_text = kTwoRules;
    session.planner = Json::object();
    add(journal::kind::kSession, after, journal::to_json(session));
  }
  void add(std::string_view kind, double after, const Json& body) {
    const auto at = static_cast<std::int64_t>((kNoon + after) * kSecond);
    rows.entries.push_back({0, at, std::string(kind), to_line(body)});
  }
  journal::Reader journal() {
    auto writer = value_of(journal::Writer::open(folder / "a.journal", {}));
    const auto done = writer.append(rows, static_cast<std::int64_t>(kNoon) * kSecond,
                                    journal::Durability::kProcessEnd);
    EXPECT_TRUE(done) << done.error();
    return value_of(journal::Reader::open(folder / "a.journal"));
  }
  std::vector<Incident> since(double after, const std::set<std::string>& open_now = {}) {
    return value_of(incidents_of(journal(), kNoon + after, open_now)).incidents;
  }

  const TestFolder folder;
  journal::Batch rows;
};
TEST_F(JournalIncidents, TellTheCauseTheEffectsAndTheRepair) {
  session(0);
  tell(9.5, {{"type", "component_lost"}, {"component", "camera"}});
  detected(10, "FusionSilent", "WARNING");
  detected(10.5, "CameraDead");
  chosen(10.5, "CameraDead", "replace");
  resolved(13, "CameraDead", "replace");
  resolved(14, "FusionSilent");
  const auto all = since(0);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_THAT(all[0].causes, ElementsAre("camera"));
  EXPECT_THAT(all[0].rules, ElementsAre("FusionSilent", "CameraDead"));
  EXPECT_THAT(all[0].consequences, ElementsAre("FusionSilent"));
  EXPECT_THAT(all[0].helped, ElementsAre("replace"));
  EXPECT_EQ(all[0].worst, Criticality::kError);
  EXPECT_TRUE(all[0].is_over);
  EXPECT_FALSE(all[0].is_cut);
  EXPECT_NEAR(all[0].began, kNoon + 10, 1e-3);
  EXPECT_NEAR(all[0].seconds, 4, 1e-3);
  const auto events =
      value_of(events_of(journal::Reader(value_of(journal::Reader::open(folder / "a.journal"))),
                         all[0].first_row, all[0].last_row));
  ASSERT_EQ(events.size(), 6u);
  EXPECT_EQ(journal::text_of(events[0].event, "type"), "component_lost");
  EXPECT_THAT(events[3].components, ElementsAre("camera"));
  EXPECT_NEAR(events[5].wall, kNoon + 14, 1e-3);
}

TEST_F(JournalIncidents, NameTheExitedComponentWhereNoneIsBlamed) {
  session(0);
  tell(9, {{"type", "component_lost"}, {"component", "camera"}});
  detected(10, "CameraDead");
  resolved(11, "CameraDead");
  const auto all = since(0);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_THAT(all[0].causes, ElementsAre("camera"));
  EXPECT_THAT(all[0].consequences, IsEmpty());
  EXPECT_THAT(all[0].helped, IsEmpty());
}

// A page that is opened the day after shows what lasts, since when it lasts.
TEST_F(JournalIncidents, ThatBeganBeforeAreToldFromTheirBeginning) {
  session(0);
  detected(10, "CameraDead");
  chosen(11, "CameraDead", "replace");
  detected(50, "FusionSilent");
  resolved(60, "FusionSilent");
  tell(70, {{"type", "rule_exhausted"}, {"rule", "CameraDead"}});
  for (const double from : {5.0, 40.0, 65.0}) {
    const auto all = since(from);
    ASSERT_EQ(all.size(), 1u) << from;
    EXPECT_NEAR(all[0].began, kNoon + 10, 1e-3) << from;
    EXPECT_TRUE(all[0].is_given_up) << from;
    EXPECT_FALSE(all[0].is_over) << from;
    rows.entries.clear();
  }
  EXPECT_EQ(since(80).size(), 0u) << "nothing was said of it since";
}

// Two at a time, each with what is its own; what a manager told is told again.
TEST_F(JournalIncidents, AreThoseThatTheManagerTold) {
  session(0, 1);
  tell(9.5, {{"type", "component_lost"}, {"component", "camera"}});
  detected(10, "CameraDead");
  incident(10, "incident_opened", "a-000", "CameraDead", {}, "camera", 0);
  detected(11, "FusionSilent", "WARNING");
  incident(11, "incident_opened", "b-000", "FusionSilent", {}, "fusion", 0,
           {{"criticality", "WARNING"}});
  resolved(12, "FusionSilent", "again");
  incident(12, "incident_closed", "b-000", "FusionSilent", {}, "fusion", 0, {{"how", "resolved"}});
  incident(13, "incident_changed", "a-000", "CameraDead", {}, "camera", 3,
           {{"exhausted", true}, {"needs_person", true}});
  const auto all = since(0);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].id, "a-000") << "the open one first";
  EXPECT_TRUE(all[0].needs_person);
  EXPECT_TRUE(all[0].is_given_up);
  EXPECT_NEAR(all[0].began, kNoon + 10, 1e-3);
  EXPECT_THAT(all[0].causes, ElementsAre("camera"));
  EXPECT_THAT(all[0].helped, IsEmpty());
  EXPECT_EQ(all[1].id, "b-000");
  EXPECT_TRUE(all[1].is_over);
  EXPECT_NEAR(all[1].seconds, 1, 1e-3);
  EXPECT_THAT(all[1].helped, ElementsAre("again"));
  EXPECT_EQ(all[1].worst, Criticality::kWarning);
  const auto events =
      value_of(events_of(journal::Reader(value_of(journal::Reader::open(folder / "a.journal"))),
                         all[0].first_row, all[0].last_row));
  EXPECT_EQ(journal::text_of(events.at(0).event, "type"), "component_lost")
      << "its beginning belongs to it";
}

TEST_F(JournalIncidents, OfAManagerAreToldFromTheirOpeningHoweverLongAgo) {
  session(0, 1);
  detected(10, "CameraDead");
  incident(10, "incident_opened", "a-000", "CameraDead", {}, "camera", 0);
  for (int i = 0; i < 200; ++i) tell(11 + i, {{"type", "trouble"}, {"what", "a disk is full"}});
  incident(300, "incident_changed", "a-000", "CameraDead", {"FusionSilent"}, "camera", 290);
  for (const double from : {5.0, 250.0}) {
    const auto all = since(from);
    ASSERT_EQ(all.size(), 1u) << from;
    EXPECT_NEAR(all[0].began, kNoon + 10, 1e-3) << from;
    EXPECT_THAT(all[0].consequences, ElementsAre("FusionSilent"));
    rows.entries.clear();
  }
  EXPECT_EQ(since(400).size(), 0u) << "nothing was said of it since";
  EXPECT_EQ(since(400, {"a-000"}).size(), 1u) << "but it is known to be open";
  EXPECT_TRUE(value_of(report_of(journal(), "a-000", folder / "none", kNoon + 500)))
      << "whatever its id says of its beginning";
}

// An effect that clears a moment after its cause is no cause.
TEST_F(JournalIncidents, CallTheRootNoEffectIfOneOfItsEffectsOutlivesIt) {
  session(0, 1);
  incident(10, "incident_opened", "a-000", "CameraDead", {}, "camera", 0);
  incident(11, "incident_changed", "a-000", "CameraDead", {"FusionSilent"}, "camera", 1);
  incident(12, "incident_changed", "a-000", "FusionSilent", {}, "camera", 2);
  incident(13, "incident_closed", "a-000", "FusionSilent", {}, "camera", 3, {{"how", "resolved"}});
  const auto all = since(0);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_THAT(all[0].rules, ElementsAre("CameraDead", "FusionSilent"));
  EXPECT_THAT(all[0].consequences, ElementsAre("FusionSilent"));
}

TEST_F(JournalIncidents, TakeTheFailureThatWasSeenFirstForAnEffectIfAnotherExplainsIt) {
  session(0, 1);
  incident(10, "incident_opened", "a-000", "FusionSilent", {}, "fusion", 0);
  incident(11, "incident_changed", "a-000", "CameraDead", {"FusionSilent"}, "camera", 1);
  EXPECT_THAT(since(0).at(0).consequences, ElementsAre("FusionSilent"));
}

TEST_F(JournalIncidents, SayHowTheyEnded) {
  session(0, 1);
  incident(10, "incident_opened", "a-000", "CameraDead", {}, "camera", 0);
  incident(11, "incident_opened", "b-000", "FusionSilent", {}, "fusion", 0);
  incident(12, "incident_closed", "b-000", "FusionSilent", {}, "fusion", 0,
           {{"how", "merged"}, {"into", "a-000"}});
  incident(13, "incident_closed", "a-000", "CameraDead", {}, "camera", 0, {{"how", "lost"}});
  incident(14, "incident_opened", "c-000", "CameraDead", {}, "camera", 0);
  session(20, 1);
  const auto all = since(0);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_TRUE(all[0].is_cut);
  EXPECT_EQ(all[1].merged_into, "a-000");
  EXPECT_TRUE(all[2].is_lost);
}

TEST_F(JournalIncidents, ThatCulpritDidNotSeeTheEndOfAreCut) {
  session(0);
  detected(10, "CameraDead");
  session(20);
  detected(21, "CameraDead");
  resolved(22, "CameraDead", "replace");
  const auto all = since(0);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_FALSE(all[0].is_cut) << "the newest first";
  EXPECT_TRUE(all[1].is_cut);
  EXPECT_NE(all[0].id, all[1].id);
}

// The failure of a dry run stays: its last event comes early, and culprit watches it until Ctrl-C.
TEST_F(JournalIncidents, ThatAreCutLastedUntilTheLastSignOfTheirRun) {
  const auto stopped = [&](double after) {
    add(journal::kind::kEnd, after, {{"text", "culprit was asked to stop"}});
  };
  session(0);  // of an older culprit
  detected(10, "CameraDead");
  chosen(10.8, "CameraDead", "replace");
  stopped(25);
  session(100, 1);
  incident(110, "incident_opened", "a-000", "CameraDead", {}, "camera", 0);
  chosen(110.8, "CameraDead", "replace");
  stopped(130);
  session(200, 1);
  const auto all = since(0);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_TRUE(all[0].is_cut);
  EXPECT_NEAR(all[0].seconds, 20, 1e-3);
  EXPECT_TRUE(all[1].is_cut);
  EXPECT_NEAR(all[1].seconds, 15, 1e-3);
}

TEST_F(JournalIncidents, OfNothingAreNone) { EXPECT_THAT(since(0), IsEmpty()); }

// Rows come from a file: what is no event says nothing.
TEST_F(JournalIncidents, TakeNothingFromRowsThatSayNothing) {
  session(0);
  for (const Json& body : {Json(nullptr), Json(7), Json::array(), Json{{"type", 7}},
                           Json{{"type", "failure_resolved"}}})
    add(journal::kind::kEvent, 1, body);
  tell(2, {{"type", "failure_detected"}, {"rule", "NobodyKnowsThis"}, {"criticality", 9}});
  chosen(3, "NobodyKnowsThis", "nothing");
  const auto all = since(0);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_THAT(all[0].causes, IsEmpty());
  EXPECT_THAT(all[0].rules, ElementsAre("NobodyKnowsThis"));
}

TEST(Incident, HasAnIdOfItsBeginning) {
  EXPECT_EQ(id_of_beginning(kNoon + 0.123), "mywpiwzf");
  EXPECT_EQ(id_of_beginning(-5), "0");
}

// With the rules of its time, and with the text for incidents without a recording.
TEST_F(JournalIncidents, AreReportedByTheirIds) {
  session(0);
  detected(1, "FusionSilent", "WARNING");
  resolved(2, "FusionSilent");
  tell(9.5, {{"type", "component_lost"}, {"component", "camera"}});
  detected(10, "CameraDead");
  chosen(10.5, "CameraDead", "replace");
  const auto reader = journal();
  const auto all = value_of(incidents_of(reader, kNoon)).incidents;
  ASSERT_EQ(all.size(), 2u);
  EXPECT_NEAR(began_by_id(all[0].id).value_or(0), kNoon + 10, 1e-3);
  const auto content = value_of(report_of(reader, all[0].id, folder / "recordings", kNoon + 100));
  ASSERT_TRUE(content);
  EXPECT_THAT(content->incident.causes, ElementsAre("camera"));
  ASSERT_EQ(content->events.size(), 3u);
  EXPECT_EQ(content->events[1]["label"], "detected");
  EXPECT_FALSE(content->curves);
  EXPECT_THAT(content->remarks, ElementsAre(testing::HasSubstr("culprit run --record")));
  EXPECT_EQ(began_by_id("mywpiwzf-0k7"), began_by_id("mywpiwzf"));
  for (const char* other : {"mywpiwzf-0k7", "mywpiwzf-", "mywpiwzf-0K7", "mywpiwzf-0k7x", "0", "1",
                            "zzzzzzzzzzzz", "zzzzzzzzzzzzzzzzzzzzzzzzzzzz", "", "-o", "mgh k"})
    EXPECT_FALSE(value_of(report_of(reader, other, folder / "recordings", kNoon))) << other;
}

TEST_F(JournalIncidents, TellWhatWasAskedAndAnswered) {
  const auto asked = [&](double after, int command, const char* text) {
    add(journal::kind::kIntent, after, {{"command", command}, {"text", text}});
  };
  const auto answered = [&](double after, int command, const char* outcome, const char* reason) {
    add(journal::kind::kOutcome, after,
        {{"command", command}, {"outcome", outcome}, {"reason", reason}});
  };
  session(0);
  asked(5, 1, "camera: before the incident");
  detected(10, "CameraDead");
  answered(10.5, 1, "done", "");
  asked(11, 2, "camera: deactivate");
  asked(11.5, 3, "camera: activate");
  answered(12, 2, "refused", "it is busy");
  resolved(13, "CameraDead", "replace");
  answered(14, 3, "done", "");
  const auto reader = journal();
  const std::string id = value_of(incidents_of(reader, kNoon)).incidents.at(0).id;
  const auto content = value_of(report_of(reader, id, folder / "none", kNoon + 100));
  ASSERT_TRUE(content);
  ASSERT_EQ(content->requests.size(), 2u);
  EXPECT_EQ(content->requests[0].text, "camera: deactivate");
  EXPECT_EQ(content->requests[0].answer, "refused, it is busy");
  EXPECT_NEAR(content->requests[0].seconds.value_or(0), 1, 1e-3);
  EXPECT_EQ(content->requests[1].answer, "done") << "it came after the incident";
}

// An incident that is not over has lasted as long as the journal goes, not until a reader looks a week later.
TEST_F(JournalIncidents, ThatAreNotOverHaveLastedAsLongAsTheJournalTells) {
  session(0);
  detected(10, "CameraDead");
  add(journal::kind::kEvent, 25, {{"type", "trouble"}, {"text", "a disk is full"}, {"time", 0}});
  const auto reader = journal();
  const std::string id = value_of(incidents_of(reader, kNoon)).incidents.at(0).id;
  const auto content = value_of(report_of(reader, id, folder / "none", kNoon + 7 * 86'400));
  ASSERT_TRUE(content);
  EXPECT_NEAR(content->incident.seconds, 15, 1e-3);
}

}  // namespace
}  // namespace culprit::incident_reports
