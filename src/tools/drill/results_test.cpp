#include "drill/results.h"

#include <csignal>
#include <sys/resource.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "base/text_file.h"
#include "drill/drill_record.h"
#include "drill/drill_report.h"
#include "drill/write_back.h"
#include "language/checker.h"

namespace culprit::drill {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kDrilled = R"(# A robot.
ROBOT rover
CYCLE 200ms
CONST silence = 350ms    # three messages
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"

RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > silence
    STRATEGY camera_restart 50 2
      ADAPTATION camera restart 5
    STRATEGY camera_redeploy 50 2  # as a last try
      ADAPTATION camera redeploy 5
)";

Json event(double clock, const char* type, const char* strategy = "") {
  Json json{{"clock", clock}, {"type", type}, {"rule", "CameraDead"}};
  if (*strategy != '\0') json["strategy"] = strategy;
  return json;
}

// At second 100: killed; noticed after 0.4 s, redeployed after 1 s, well after 1.5 s.
Trial killed(int round = 1) {
  Trial trial{{Fault{FaultKind::kKill, "camera"}}, round, 100};
  Json chosen = event(100.5, "strategy_chosen", "camera_redeploy");
  chosen["components"] = {"camera"};
  trial.events = {event(100.4, "failure_detected"), chosen,
                  event(101.0, "adaptation_done", "camera_redeploy"),
                  event(101.5, "failure_resolved", "camera_redeploy")};
  trial.well = 101.5;
  trial.end = 104.5;
  return trial;
}

Results results_with(const std::vector<Trial>& trials, const Paths& paths = {}) {
  return results_of(trials, *check(Source("r", kDrilled)).rules, paths, "2026-12-01");
}

TEST(DrillTrial, IsReadAsItWasWritten) {
  Trial trial = killed();
  trial.silent["fusion"] = 100.7;
  trial.undone = 103;
  const auto trials = trials_in(to_line(to_json(trial)) + "\n{\"faults\": [{\"ki");
  ASSERT_EQ(trials.size(), 1u) << "a line that was cut is left out";
  EXPECT_EQ(to_json(trials[0]), to_json(trial));
}

TEST(DrillRecord, ResumesWhatIsNotDoneAndRefusesAnotherPlan) {
  const test::TestFolder folder;
  const DrillHead head{"rules", {"kill camera #1", "kill camera #2"}};
  auto record = DrillRecord::open(folder.path() / "drill", head);
  ASSERT_TRUE(record) << record.error();
  HealthyRobot healthy;
  healthy.edges = {{"fusion", "camera"}};
  healthy.lifecycles = {{"camera", "active"}};
  healthy.topics = {{"/rgb", {10, "camera", {"fusion"}}}};
  ASSERT_TRUE(record->keep(healthy));
  ASSERT_TRUE(record->add(killed(1)));
  Trial aborted = killed(2);
  aborted.trouble = "interrupted";
  ASSERT_TRUE(record->add(aborted));
  const auto resumed = DrillRecord::open(folder.path() / "drill", head);
  ASSERT_TRUE(resumed) << resumed.error();
  EXPECT_TRUE(resumed->has("kill camera #1"));
  EXPECT_FALSE(resumed->has("kill camera #2")) << "it proves nothing";
  EXPECT_EQ(to_json(resumed->head().healthy), to_json(healthy));
  const auto other = DrillRecord::open(folder.path() / "drill", {"other rules", head.plan});
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error(), HasSubstr("choose another --record"));
}

TEST(DrillRecord, OnAFullDiskDoesNotCountTheTrialAndGoesOnAfterwards) {
  const test::TestFolder folder;
  const DrillHead head{"rules", {"kill camera #1", "kill camera #2"}};
  auto record = DrillRecord::open(folder.path() / "drill", head);
  ASSERT_TRUE(record && record->add(killed(1)));
  const auto size = std::filesystem::file_size(record->file("trials.jsonl"));
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit few{size + 20, before.rlim_max};  // in the middle of the next line
  signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &few);
  const auto added = record->add(killed(2));
  setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(added);
  EXPECT_THAT(added.error(), HasSubstr("trials.jsonl"));
  EXPECT_FALSE(record->has("kill camera #2"));
  auto resumed = DrillRecord::open(folder.path() / "drill", head);
  ASSERT_TRUE(resumed && resumed->add(killed(2))) << "behind the line that was cut";
  resumed = DrillRecord::open(folder.path() / "drill", head);
  EXPECT_TRUE(resumed->has("kill camera #1"));
  EXPECT_TRUE(resumed->has("kill camera #2"));
}

TEST(DrillResults, SayTheRuleTheRemedyAndTheTimeOfAFault) {
  const Results results = results_with({killed(1), killed(2), killed(3)});
  ASSERT_EQ(results.faults.size(), 1u);
  const FaultResult& fault = results.faults[0];
  EXPECT_EQ(fault.noticed, 3);
  EXPECT_NEAR(spread_of(fault.noticed_after).median, 0.4, 1e-9);
  EXPECT_EQ(fault.blamed_rightly, 3);
  EXPECT_THAT(fault.helped, ElementsAre(testing::Pair("CameraDead.camera_redeploy", 3)));
  EXPECT_NEAR(spread_of(fault.well_after).most, 1.5, 1e-9);
  EXPECT_EQ(fault.healed, 3);
  EXPECT_THAT(results.unnoticed, IsEmpty());
}

TEST(DrillResults, CoverageNamesWhatNoRuleAndNoFaultReaches) {
  Trial quiet{{Fault{FaultKind::kHang, "fusion"}}, 1, 100, 103, 103, 106};
  const Results results = results_with({quiet});
  EXPECT_THAT(results.unnoticed, ElementsAre("hang fusion"));
  EXPECT_THAT(results.untripped, ElementsAre("CameraDead"));
}

TEST(DrillResults, AStrategyOnAHealthyComponentIsWrongBlame) {
  Trial trial = killed();
  trial.events[1]["components"] = {"fusion"};
  trial.events[1]["text"] = "fusion is held responsible";
  const Results results = results_with({trial});
  EXPECT_EQ(results.faults[0].blamed_wrongly, 1);
  EXPECT_THAT(results.touched, ElementsAre(testing::Pair("fusion", 1)));
  EXPECT_THAT(results.faults[0].evidence,
              ElementsAre("kill camera #1: fusion is held responsible"));
}

TEST(DrillResults, WhatTheDrillUndidIsNoSuccessOfAStrategy) {
  Trial trial = killed();
  trial.undone = 101.2;
  EXPECT_THAT(attempts_in(trial), IsEmpty());
  trial.undone.reset();
  ASSERT_EQ(attempts_in(trial).size(), 1u);
  EXPECT_NEAR(*attempts_in(trial)[0].effect, 0.5, 1e-9);
}

TEST(DrillResults, AFailureAfterTheFaultWasTakenBackIsNoneOfIt) {
  Trial trial = killed();
  trial.restored = 105;
  trial.end = 110;
  Json chosen = event(106, "strategy_chosen", "camera_restart");
  chosen["components"] = {"fusion"};
  trial.events.insert(trial.events.end(), {event(105.5, "failure_detected"), chosen,
                                           event(106.2, "adaptation_done", "camera_restart"),
                                           event(106.4, "failure_resolved", "camera_restart")});
  EXPECT_THAT(finding_of(trial).wrongly, IsEmpty());
  EXPECT_THAT(finding_of(trial).helped, ElementsAre("CameraDead.camera_redeploy"));
  ASSERT_EQ(attempts_in(trial).size(), 2u) << "but it shows what helps";
  EXPECT_EQ(attempts_in(trial)[1].strategy, "camera_restart");
  EXPECT_EQ(to_json(*trial_from(to_json(trial))), to_json(trial));
}

TEST(DrillThresholds, OfTwoRunsAreThoseOfOne) {
  const Comparison above;
  ThresholdMeasure sum{.of = above};
  add(sum, {.of = above, .values = 20, .least = 0.1, .most = 0.2, .faulty = 0.9, .looked = 10});
  add(sum, {.of = above});  // a run without values
  add(sum, {.of = above,
            .values = 30,
            .least = 0.05,
            .most = 0.15,
            .longest_beyond = 1,
            .faulty = 0.6,
            .looked = 15});
  EXPECT_EQ(sum.values, 50u);
  EXPECT_EQ(sum.least, 0.05);
  EXPECT_EQ(sum.most, 0.2);
  EXPECT_EQ(sum.longest_beyond, 1);
  EXPECT_EQ(sum.faulty, 0.6) << "the mildest";
  EXPECT_EQ(sum.looked, 25);
}

TEST(DrillResults, IntervalsHoldTheirShare) {
  EXPECT_EQ(interval_of(0, 0).high, 1);
  const Interval all = interval_of(20, 20);
  EXPECT_NEAR(all.low, 0.839, 1e-3);
  EXPECT_EQ(all.high, 1);
  const Interval half = interval_of(5, 10);
  EXPECT_NEAR(half.low, 0.237, 1e-3);
  EXPECT_NEAR(half.high, 0.763, 1e-3);
}

Trial silences(const char* fault, int round, const char* silent) {
  Trial trial{{Fault{FaultKind::kKill, fault}}, round, 100, {}, 102, 105};
  if (silent != nullptr) trial.silent[silent] = 100.6;
  return trial;
}

TEST(DrillResults, AHiddenDependencyRepeatsAndNeverHappensWithout) {
  std::vector<Trial> trials{silences("camera", 1, "fusion"), silences("camera", 2, "fusion")};
  EXPECT_THAT(results_with(trials).hidden, IsEmpty()) << "twice is not enough";
  trials.push_back(silences("camera", 3, "fusion"));
  ASSERT_EQ(results_with(trials).hidden.size(), 1u);
  EXPECT_EQ(results_with(trials).hidden[0].consumer, "fusion");
  EXPECT_EQ(results_with(trials).hidden[0].producer, "camera");
  EXPECT_THAT(results_with(trials, {{"fusion", "camera"}}).hidden, IsEmpty()) << "the graph has it";
  std::vector<Trial> once_not = trials;
  once_not.push_back(silences("camera", 4, nullptr));
  EXPECT_THAT(results_with(once_not).hidden, IsEmpty());
  trials.push_back(silences("lidar", 1, "fusion"));
  EXPECT_THAT(results_with(trials).hidden, IsEmpty()) << "it happens without";
}

TEST(DrillResults, AnEffectOfAHiddenDependencyIsNone) {
  std::vector<Trial> trials;
  for (int round = 1; round <= 3; ++round) {
    trials.push_back(silences("camera", round, "fusion"));
    trials.back().silent["planner"] = 100.8;
  }
  const Results results = results_with(trials, {{"planner", "fusion"}});
  ASSERT_EQ(results.hidden.size(), 1u);
  EXPECT_EQ(results.hidden[0].consumer, "fusion");
}

TEST(DrillWriteBack, ChangesWhatWasMeasuredAndSaysWhereFrom) {
  std::vector<Trial> trials{killed(1), killed(2), killed(3)};
  trials[2].events.erase(trials[2].events.begin() + 2, trials[2].events.end());
  trials[2].events.push_back(event(102, "strategy_failed", "camera_redeploy"));
  for (int round = 4; round <= 6; ++round) trials.push_back(silences("camera", round, "fusion"));
  for (Trial& trial : trials) trial.silent["fusion"] = 100.6;
  trials.push_back(killed(7));
  trials.back().silent["fusion"] = 100.6;
  Results results = results_with(trials);
  results.thresholds = {{.of = comparisons_in(check(Source("r", kDrilled)).file).at(0),
                         .values = 200,
                         .least = 0.09,
                         .most = 0.3,
                         .looked = 20}};
  const auto written = write_back("rover.rules", kDrilled, results);
  ASSERT_TRUE(written) << written.error();
  EXPECT_EQ(written->text, R"(# A robot.
ROBOT rover
CYCLE 200ms
CONST silence = 900ms    # three messages; drill 2026-12-01, 200 values
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
DEPENDENCY fusion ON camera    # drill 2026-12-01: silent in all 7 faults of camera

RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > silence
    STRATEGY camera_restart 50 2
      ADAPTATION camera restart 5
    STRATEGY camera_redeploy 75 4  # as a last try; drill 2026-12-01, 4 times
      ADAPTATION camera redeploy 4    # drill 2026-12-01, 3 times
)");
  EXPECT_TRUE(check(Source("r", written->text)).rules);
  Results later = results_with(trials);
  later.date = "2026-12-24";
  later.hidden.clear();
  later.strategies[1].helped = 3;
  later.strategies[1].tried = 3;
  const auto again = write_back("rover.rules", written->text, later);
  EXPECT_THAT(again->text, HasSubstr("100 3  # as a last try; drill 2026-12-24, 3 times\n"));
}

TEST(DrillWriteBack, ADurationSeparatesWhatNoThresholdDoes) {
  constexpr const char* kOverlap =
      "COMPONENT camera NODE /camera LAUNCH \"camera\"\n"
      "SIGNAL entropy DIAGNOSTIC camera KEY entropy\n"
      "RULE Bad\n  POLICIES WARNING FOR 100ms\n  TRIGGER entropy > 0.5\n"
      "    STRATEGY s 50 2\n      ADAPTATION camera redeploy 5\n";
  const Source source("r", kOverlap);
  Results results = results_of({}, *check(source).rules, {}, "2026-12-01");
  results.thresholds = {{.of = comparisons_in(check(source).file).at(0),
                         .values = 50,
                         .least = 0.1,
                         .most = 0.9,
                         .longest_beyond = 0.2,
                         .faulty = 0.8}};
  EXPECT_THAT(write_back("r", kOverlap, results)->text,
              HasSubstr("POLICIES WARNING FOR 400ms    # drill 2026-12-01, 50 values\n"));
  results.thresholds[0].longest_beyond = 4;
  EXPECT_EQ(write_back("r", kOverlap, results)->text, kOverlap) << "that is no failure";
}

TEST(DrillWriteBack, KeepsAThresholdThatSeparatesHealthyFromFaulty) {
  constexpr const char* kSeparates =
      "COMPONENT camera NODE /camera LAUNCH \"camera\"\n"
      "SIGNAL entropy DIAGNOSTIC camera KEY entropy\n"
      "RULE Bad\n  POLICIES WARNING\n  TRIGGER entropy > 0.06 || age(/rgb) > 350ms\n"
      "    STRATEGY s 50 2\n      ADAPTATION camera redeploy 5\n";
  const Source source("r", kSeparates);
  Results results = results_of({}, *check(source).rules, {}, "2026-12-01");
  const auto comparisons = comparisons_in(check(source).file);
  ASSERT_EQ(comparisons.size(), 2u);
  results.thresholds = {
      {.of = comparisons[0], .values = 500, .least = 0.03, .most = 0.04, .faulty = 0.2},
      {.of = comparisons[1], .values = 500, .least = 0.09, .most = 0.12}};
  EXPECT_EQ(write_back("r", kSeparates, results)->text, kSeparates);
  results.thresholds[0].most = 0.08;
  results.thresholds[1].most = 0.05;
  EXPECT_THAT(write_back("r", kSeparates, results)->text,
              HasSubstr("entropy > 0.11 || age(/rgb) > 150ms"))
      << "healthy values are beyond the one, and the other takes too long";
}

TEST(DrillWriteBack, RaisesAReadyThatStartsExceed) {
  constexpr const char* kSlowStarts =
      "COMPONENT camera NODE /camera LAUNCH \"camera\" READY 5s  # slow\n"
      "COMPONENT lidar NODE /lidar LAUNCH \"lidar\" READY 5s\n"
      "COMPONENT fusion NODE /fusion LAUNCH \"fusion\"\n";
  Results results = results_of({}, *check(Source("r", kSlowStarts)).rules, {}, "2026-12-01");
  results.starts = {{"camera", {2, 3, 7.2}}, {"lidar", {1, 2, 3}}, {"fusion", {9, 9, 9}}};
  EXPECT_EQ(write_back("r", kSlowStarts, results)->text,
            "COMPONENT camera NODE /camera LAUNCH \"camera\" READY 8s  # slow; drill 2026-12-01, 3 "
            "starts\n"
            "COMPONENT lidar NODE /lidar LAUNCH \"lidar\" READY 5s\n"
            "COMPONENT fusion NODE /fusion LAUNCH \"fusion\"\n");
  EXPECT_THAT(report_lines(results), testing::Contains(HasSubstr("8s")));
}

TEST(DrillResults, CountOnlyWhatRulesOfTheFileNoticed) {
  Trial trial{{Fault{FaultKind::kKill, "fusion"}}, 1, 100, {}, 102, 105};
  for (const char* rule : {"fusion_failed", "drill_interlock_1"})
    trial.events.push_back({{"clock", 100.2}, {"type", "failure_detected"}, {"rule", rule}});
  EXPECT_EQ(finding_of(trial).rule, "fusion_failed");
  EXPECT_EQ(results_with({trial}).faults[0].noticed, 0);
}

TEST(DrillWriteBack, WritesNothingWithoutEnoughOutcomes) {
  const auto written = write_back("r", kDrilled, results_with({killed(1), killed(2)}));
  EXPECT_EQ(written->text, kDrilled);
}

TEST(DrillWriteBack, NamesWhatStandsElsewhere) {
  Results results = results_with({killed(1), killed(2), killed(3)});
  results.strategies[1].rule = "FromAPack";
  EXPECT_THAT(write_back("r", kDrilled, results)->unwritten,
              ElementsAre(HasSubstr("FromAPack.camera_redeploy")));
}

TEST(DrillReport, IsOnePageAndOneDocument) {
  Trial hostile = killed();
  hostile.trouble = "<script>";
  const Results results = results_with({killed(), hostile});
  const std::string page = report_page(results);
  EXPECT_THAT(page, HasSubstr("kill camera"));
  EXPECT_THAT(page, testing::Not(HasSubstr("<script")));
  const Json json = report_json(results);
  EXPECT_EQ(json["faults"][0]["noticed"], 1);
  EXPECT_EQ(json["strategies"][1]["impact"], 4);
  EXPECT_THAT(report_lines(results), testing::Contains(HasSubstr("wrong blame")).Times(0));
  EXPECT_EQ(line_of(killed()),
            "kill camera: noticed after 0.40 s by CameraDead, helped by "
            "CameraDead.camera_redeploy, well after 1.50 s");
}

}  // namespace
}  // namespace culprit::drill
