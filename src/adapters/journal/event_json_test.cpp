// The words of events on disk.
#include "journal/event_json.h"

#include <fstream>
#include <set>

#include <gtest/gtest.h>

#include "knowledge/event_words.h"
#include "language/checker.h"

namespace culprit::journal {
namespace {

using namespace std::chrono_literals;

constexpr const char* kRules = R"(
COMPONENT camera NODE /camera
RULE R
  POLICIES ERROR
  TRIGGER age(/rgb) > 1s && parameter(camera, gain) > 1 && load > 1 && level(driver) > 1
    STRATEGY s 90 10
      ADAPTATION camera restart 1
    STRATEGY t 90 10
      ADAPTATION camera redeploy 1
)";

std::vector<EventWhat> samples() {
  const RuleId r(0);
  const StrategyId s(0);
  const ComponentId c(0);
  const Candidate chosen{s, 0.5, std::nullopt, {}, std::nullopt, "", 0.9, 2};
  const Candidate tried{StrategyId(1), 0.75, Condition::kTried, {}, std::nullopt, "", 0, 0};
  const std::vector<Candidate> candidates{chosen, tried};
  const std::vector<Suspect> suspects{
      {c, r, 0.25, {{EvidenceSource::kKernel, "camera exited", 1200ms, 2.5, "fusion"}}}};
  return {FailureDetected{r},
          FailureResolved{r, FailureResolved::How::kByStrategy, s, 1500ms},
          FailureResolved{r, FailureResolved::How::kWithoutStrategy, std::nullopt, 2s},
          FailureLost{r},
          StrategyChosen{s, candidates, {r}, true, suspects},
          FailureHeldBack{r, candidates, suspects},
          AdaptationDone{s, 0, "reads back false"},
          AdaptationFailed{s, 0, "refused"},
          StrategyFailed{s, "the failure is still there"},
          StrategyResumed{s},
          Undone{s, "gain of camera is 1", false},
          RoundSpent{r, Time(9s)},
          LastResortReached{r},
          LastResortDone{s},
          RuleExhausted{r},
          ComponentLost{c, "killed"},
          ComponentFound{c, 42},
          NeverSeen{c, "/camra"},
          NeverSeen{TopicId(0), ""},
          NeverSeen{SignalId(0), ""},
          NeverSeen{ParameterId(0), ""},
          NeverSeen{DiagnosticId(0), ""},
          LifecycleIntended{c, Lifecycle::kInactive},
          LifecycleIntended{c, Lifecycle::kInactive, true},
          CameUp{c, {ComingUp::Driver::kOther, 3ns, 4ns}},
          RivalSeen{c},
          Trouble{"a disk is full"},
          OrderAccepted{{1, "ada", "why", Pause{}}},
          OrderAccepted{{1, "ada", "why", Pause{}}, {s}},
          OrderAccepted{{1, "ada", "", SetDryRun{false}}},
          OrderAccepted{{1, "ada", "", Silence{c, 5s}}},
          OrderAccepted{{1, "ada", "", LiftSilence{r}}},
          OrderAccepted{{1, "ada", "", RunStrategy{s}}},
          OrderAccepted{{1, "ada", "", Forget{r}}},
          OrderRefused{{1, "ada", "", Approve{StrategyId(9)}}, "it does not wait"},
          ActionHeldBack{s, Restraint::kStorm, "a storm", Time(9s)},
          ActionHeldBack{s, Restraint::kPaused, "paused by a person", kNever, candidates, suspects},
          ApprovalAsked{s, candidates, suspects},
          ApprovalLapsed{s},
          StrategyAbandoned{s, "paused"},
          OrderCarriedOut{s},
          OutcomePending{s, true, Time(9s)},
          OutcomeCounted{s, OutcomeCounted::As::kSuccess},
          FailureFlaps{r, 3},
          SilenceEnded{c},
          StormBegan{Restraint::kStorm, "too much"},
          StormEnded{},
          JudgementSuspended{"deaf"},
          JudgementResumed{},
          SleepNoticed{3s},
          PriorsAdopted{{{s, 4.5, 1.5}}, "3 robots"},
          HostSilent{"rover2", {c}, true},
          HostBack{"rover2"},
          ValueUnknown{InputId(2), WhyUnknown::kOverflow},
          ValueUnknown{InputId(2), WhyUnknown::kNotANumber},
          ValueUnknown{InputId(1), WhyUnknown::kNotANumber},
          RuleBlind{r, {Time(3ns), Unseen::kNeverSeen, "signal load", "lode"}},
          RuleBlind{r, {Time(3ns), Unseen::kStale, "load", ""}},
          RuleBlind{r, {Time(3ns), Unseen::kNoResult, "", ""}},
          RuleSees{r, 4s},
          StaysDown{{c}, StaysDown::Why::kPerson, 50},
          StaysDown{{c}, StaysDown::Why::kDoubt, 50, c, 700ms},
          StaysDown{{c}, StaysDown::Why::kOwner},
          StaysDown{{c}, StaysDown::Why::kTerminal},
          StaysDown{{c}, StaysDown::Why::kFrozen},
          StaysDown{{c}, StaysDown::Why::kUnloaded},
          OrderAccepted{{1, "ada", "", Revive{}}},
          OrderAccepted{{1, "ada", "", EndStarted{}}},
          IncidentOpened{{.id = "mywpiwzf-0k7",
                          .root = r,
                          .consequences = {r},
                          .components = {c},
                          .is_certain = true,
                          .since = Time(3ns),
                          .criticality = Criticality::kError,
                          .condition = "dead",
                          .headline = "camera is down"}},
          IncidentChanged{{.id = "mywpiwzf-0k7",
                           .root = r,
                           .components = {c},
                           .host = "rover2",
                           .since = Time(3ns),
                           .is_exhausted = true,
                           .headline = "nothing is heard of rover2, where camera ran"}},
          IncidentClosed{"mywpiwzf-0k7", r},
          IncidentClosed{"mywpiwzf-0k7", r, IncidentEnd::kMerged, "mywpiwzf-0k8"}};
}

std::vector<std::string> golden_rows() {
  std::ifstream file("src/adapters/journal/golden/events.jsonl");
  std::vector<std::string> rows;
  for (std::string row; std::getline(file, row);) rows.push_back(row);
  return rows;
}

// A replay compares hashes of them: old journals would not replay any more.
TEST(EventJson, RowsAreAsTheyHaveAlwaysBeen) {
  const RuleSet rules = *check(Source("test", kRules)).rules;
  const auto events = samples();
  const auto rows = golden_rows();
  ASSERT_EQ(events.size(), rows.size());
  std::set<EventKind> seen;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    seen.insert(events[i].index());
    const Event event{Time(7ns), events[i]};
    EXPECT_EQ(line_of(event, rules), rows[i]);
    EXPECT_EQ(to_line(to_json(event, rules)), rows[i]);
  }
  EXPECT_EQ(seen.size(), std::variant_size_v<EventWhat::Variant>) << "each has a sample";
}

TEST(EventJson, ARowSaysWhatWouldEndAWait) {
  const RuleSet rules = *check(Source("test", kRules)).rules;
  Candidate waits{StrategyId(0), 0.5, Condition::kSuspect, {}, std::nullopt, ""};
  waits.within = 600ms;
  const Json row = to_json(Event{Time(7ns), FailureHeldBack{RuleId(0), {waits}}}, rules);
  EXPECT_EQ(row["candidates"][0]["ends"],
            "if camera does not answer within 0.60 s, camera is held responsible");
}

TEST(EventJson, WhatIsReadBackIsWrittenAgainWithTheSameNames) {
  const RuleSet rules = *check(Source("test", kRules)).rules;
  std::size_t read = 0;
  for (const std::string& text : golden_rows()) {
    const Json row = parse_json(text);
    const auto event = event_from_json(row, rules);
    if (!event) continue;
    ++read;
    EXPECT_EQ(event->at, Time(7ns));
    const Json again = to_json(*event, rules);
    for (const char* key :
         {"type",         "rule",      "strategy", "component", "adaptation", "order",
          "pid",          "lifecycle", "owed",     "driver",    "joining_ns", "helped",
          "due",          "as",        "times",    "time_ns",   "lasts_ns",   "dry_run",
          "succeeded",    "author",    "since",    "why",       "input",      "near",
          "blind_for_ns", "launcher",  "fell",     "after_ns",  "components"})
      EXPECT_EQ(again.value(key, Json()), row.value(key, Json())) << key << " of " << text;
  }
  EXPECT_EQ(read, 52u) << "all but those whose rows hold too little";
}

TEST(EventJson, ReadsNothingThatTheRulesDoNotHaveOrThatIsDamaged) {
  const RuleSet rules = *check(Source("test", kRules)).rules;
  for (const char* row : {
           R"([])",
           R"("failure_detected")",
           R"({"type": 7})",
           R"({"type": ""})",
           R"({"type": "invented", "rule": "R"})",
           R"({"type": "failure_detected"})",
           R"({"type": "failure_detected", "rule": "Other"})",
           R"({"type": "strategy_failed", "rule": "R", "strategy": "gone"})",
           R"({"type": "adaptation_done", "rule": "R", "strategy": "s", "adaptation": 1})",
           R"({"type": "adaptation_done", "rule": "R", "strategy": "s", "adaptation": -1})",
           R"({"type": "component_found", "component": "camera", "pid": 4294967297})",
           R"({"type": "lifecycle_intended", "component": "camera", "lifecycle": "tired"})",
           R"({"type": "rule_blind", "rule": "R", "why": "tired"})",
           R"({"type": "stays_down", "components": ["camera"], "why": "tired"})",
           R"({"type": "stays_down", "components": ["gone"], "why": "person"})",
           R"({"type": "stays_down", "components": "camera", "why": "person"})",
           R"({"type": "order_accepted", "order": "silence", "component": "gone"})",
           R"({"type": "order_accepted", "order": "shout"})",
       })
    EXPECT_FALSE(event_from_json(parse_json(row), rules)) << row;
}

// By which strategy it was resolved may be one that the rules no longer have.
TEST(EventJson, AResolutionCountsWithoutItsStrategy) {
  const RuleSet rules = *check(Source("test", kRules)).rules;
  const auto event = event_from_json(
      parse_json(R"({"type": "failure_resolved", "rule": "R", "strategy": "gone"})"), rules);
  ASSERT_TRUE(event);
  EXPECT_FALSE(std::get<FailureResolved>(event->what).strategy);
}

}  // namespace
}  // namespace culprit::journal
