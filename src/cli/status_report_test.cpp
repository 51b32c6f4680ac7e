#include "cli/status_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/terminal_screen.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string all_of(const WhatCulpritSays& said) {
  std::string text;
  for (const auto& lines :
       {situation_lines(said, Colour::kOff), component_lines(said, Colour::kOff),
        event_lines(said, 5, Colour::kOff), about_lines(said)}) {
    for (const std::string& line : lines) text += line + "\n";
  }
  return text;
}

WhatCulpritSays well() {
  WhatCulpritSays said;
  said.about = parse_json(
      R"({"version": "1.2", "process": 4711, "domain": 3, "node": "culprit", "rules": "my.rules"})");
  said.robot =
      parse_json(R"({"robot": "rover", "components": [{"name": "camera"}, {"name": "fusion"}]})");
  said.state =
      parse_json(R"({"t": 20, "clock": 1795538720, "incidents": [], "rules": [{"phase": "quiet"}],
      "overview": {"look": "OK", "headline": "all is well", "detail": "no failure is seen by 1 rule"},
      "components": [{"health": "OK", "look": "OK", "condition": "", "alive": true, "process": "running", "present": true},
                     {"health": "OK", "look": "OK", "condition": "", "alive": true, "process": "running", "present": true}]})");
  said.control = parse_json(
      R"({"paused": false, "dry_run": false, "hears": true, "silences": [], "asked": []})");
  return said;
}

WhatCulpritSays ill() {
  WhatCulpritSays said = well();
  said.state["incidents"].push_back(parse_json(
      R"({"id": "mywpiwzf-0k7", "headline": "camera is down", "health": "ERROR", "since": 11.5,
      "rule": "CameraGone", "components": ["camera"], "certain": true, "consequences": ["FusionSilent", "PoseSilent"],
      "needs_person": false, "doing": "being repaired: redeploy camera", "next": "redeploy is being carried out"})"));
  said.state["overview"] = {{"look", "ERROR"}, {"headline", "camera is down"}};
  said.state["components"][0] = parse_json(
      R"({"health": "ERROR", "look": "ERROR", "condition": "down", "alive": false, "process": "gone", "adapting": "redeploy"})");
  said.state["rules"][0]["phase"] = "attempting";
  return said;
}

TEST(StatusReport, NamesTheComponentsThatWereNeverSeen) {
  WhatCulpritSays said = well();
  said.state["components"][1] = parse_json(
      R"({"health": "OK", "look": "NEVER_SEEN", "condition": "never seen", "alive": null, "present": false})");
  EXPECT_THAT(all_of(said), HasSubstr("2 components, 1 never seen (fusion); 1 rule"));
  // Until its time to show itself is over, nothing is known of it.
  said.state["components"][1]["condition"] = "not seen yet";
  EXPECT_THAT(all_of(said), HasSubstr("2 components; 1 rule"));
}

TEST(StatusReport, SaysThatAllIsWell) {
  EXPECT_EQ(verdict_of(well()), Verdict::kWell);
  EXPECT_THAT(all_of(well()), HasSubstr("rover: all is well\n"));
  EXPECT_THAT(all_of(well()), HasSubstr("2 components; 1 rule, 0 with a failure"));
  EXPECT_THAT(all_of(well()),
              HasSubstr("culprit 1.2, process 4711, domain 3, node /culprit, rules my.rules"));
}

TEST(StatusReport, SaysTheFailureTheBlameAndTheNextStep) {
  EXPECT_EQ(verdict_of(ill()), Verdict::kNotWell);
  const std::string text = all_of(ill());
  EXPECT_THAT(text, HasSubstr("rover: camera is down\n"));
  EXPECT_THAT(text,
              HasSubstr("  camera is down  (ERROR, rule CameraGone, incident mywpiwzf-0k7)\n"));
  EXPECT_THAT(text, HasSubstr(", for 8.5 s\n"));
  EXPECT_THAT(text, HasSubstr("and so fail FusionSilent and PoseSilent\n"));
  EXPECT_THAT(text, HasSubstr("now: being repaired: redeploy camera\n"));
  EXPECT_THAT(text, HasSubstr("next: redeploy is being carried out\n"));
  EXPECT_THAT(text, HasSubstr("1 down (camera)"));
}

TEST(StatusReport, SaysWhatKeepsCulpritFromActingAndHowToLetItGoOn) {
  WhatCulpritSays said = well();
  said.control["paused"] = true;
  said.control["silences"].push_back(
      {{"component", "fusion"}, {"until", 80}, {"author", "ada"}, {"reason", "lens"}});
  said.control["asked"].push_back({{"rule", "CameraGone"}, {"strategy", "redeploy"}});
  EXPECT_EQ(verdict_of(said), Verdict::kNotWell) << "nobody would be helped";
  const std::string text = all_of(said);
  EXPECT_THAT(text, HasSubstr("rover: all is well  [paused, asks and mutes something]"));
  EXPECT_THAT(text, HasSubstr("culprit resume"));
  EXPECT_THAT(text, HasSubstr("culprit approve CameraGone.redeploy"));
  EXPECT_THAT(text, HasSubstr("by ada (lens); culprit mute --lift fusion"));
}

// The nodes of a demonstration end with it.
TEST(StatusReport, SaysWhetherAStartedProcessOutlivesCulprit) {
  WhatCulpritSays said = well();
  said.control["started"] = parse_json(R"([{"component": "camera", "pid": 17}])");
  said.about["version"] = "1.2";
  EXPECT_THAT(all_of(said), HasSubstr("camera (process 17); it runs on when culprit ends"));
  said.about["version"] = "";
  EXPECT_THAT(all_of(said), HasSubstr("camera (process 17); it ends with culprit"));
}

WhatCulpritSays with_blind(const char* criticality) {
  WhatCulpritSays said = well();
  said.robot["rules"] = parse_json(R"([{"name": "CameraGone", "criticality": "ERROR"},
                                       {"name": "BatteryLow"}])");
  said.robot["rules"][1]["criticality"] = criticality;
  said.state["rules"].push_back(parse_json(
      R"({"phase": "quiet", "trigger": null, "blind": {"since": 11.5, "why": "never_seen",
          "input": "battery", "near": "charge",
          "text": "signal battery was never seen; did you mean 'charge'?"}})"));
  said.state["overview"] = {{"look", criticality == std::string("ERROR") ? "BLIND_ERROR" : "BLIND"},
                            {"headline", "no failure is seen, but BatteryLow is blind"}};
  return said;
}

TEST(StatusReport, NeverSaysThatAllIsWellWhileARuleIsBlind) {
  for (const char* criticality : {"ERROR", "WARNING", "NON_CRITICAL"}) {
    const WhatCulpritSays said = with_blind(criticality);
    const std::string text = all_of(said);
    EXPECT_THAT(text, HasSubstr("rover: no failure is seen, but BatteryLow is blind\n"));
    EXPECT_THAT(text,
                HasSubstr("  BatteryLow is blind: signal battery was never seen; did you mean "
                          "'charge'?  (" +
                          std::string(criticality) + ", since "));
    EXPECT_THAT(text, HasSubstr("2 rules, 0 with a failure, 1 blind"));
  }
  EXPECT_EQ(verdict_of(with_blind("ERROR")), Verdict::kNotWell);
  EXPECT_EQ(verdict_of(with_blind("WARNING")), Verdict::kSeesLess);
}

// No rule sees a failure, and yet not all is well: the exit status is another one, too.
TEST(StatusReport, SeesLessWhileAComponentIsNotThere) {
  for (const char* look : {"NEVER_SEEN", "DEAD", "HUNG", "STOPPED", "UNREACHABLE"}) {
    WhatCulpritSays said = well();
    said.state["overview"] = {{"look", look}, {"headline", "fusion is not there"}};
    EXPECT_EQ(verdict_of(said), Verdict::kSeesLess) << look;
    EXPECT_THAT(all_of(said), HasSubstr("rover: fusion is not there\n"));
    said.control["paused"] = true;
    EXPECT_EQ(verdict_of(said), Verdict::kNotWell) << look;
  }
}

TEST(StatusReport, SaysThatNothingIsWatchedIfNoRuleCanSee) {
  WhatCulpritSays said = with_blind("WARNING");
  said.state["overview"] = {{"look", "WATCHING_NOTHING"},
                            {"headline", "watching nothing: no rule can see"}};
  EXPECT_THAT(all_of(said), HasSubstr("rover: watching nothing: no rule can see\n"));
  EXPECT_EQ(verdict_of(said), Verdict::kNotWell);
}

TEST(StatusReport, NeverSaysThatARobotIsWellThatCannotBeHeard) {
  WhatCulpritSays said = well();
  said.control["hears"] = false;
  said.state["overview"] = {{"look", "DEAF"},
                            {"headline", "culprit does not receive the robot's messages"}};
  EXPECT_EQ(verdict_of(said), Verdict::kNotWell);
  EXPECT_THAT(all_of(said),
              HasSubstr("rover: culprit does not receive the robot's messages  [deaf]"));
  EXPECT_THAT(all_of(WhatCulpritSays{}), HasSubstr("nothing is known yet"));
}

TEST(StatusReport, GivesNoHealthToWhatNoRuleJudges) {
  WhatCulpritSays said = well();
  said.state["components"][0] =
      parse_json(R"({"health": "OK", "look": "NEVER_SEEN", "condition": "never seen"})");
  const std::string text = all_of(said);
  EXPECT_THAT(text, testing::ContainsRegex("camera +\\? +never seen"));
  EXPECT_THAT(text, testing::ContainsRegex("fusion +OK +running"));
  for (const auto& [look, condition] :
       {std::pair("DEAD", "down"), std::pair("TIME_HELD", "clock paused")}) {
    said.state["components"][0] = {{"health", "OK"}, {"look", look}, {"condition", condition}};
    EXPECT_THAT(all_of(said), testing::ContainsRegex(std::string("camera +\\? +") + condition));
  }
}

TEST(StatusReport, TakesDocumentsOfAnyForm) {
  for (const char* text :
       {"1", "[]", "\"x\"", "{}", R"({"components": 1, "incidents": {"a": 1}, "rules": [1, null]})",
        R"({"components": [1, null, {}], "incidents": [1, null, [], {"since": "x"}], "t": "x",
                               "clock": [], "silences": [3], "asked": [null], "paused": 1, "hears": "yes"})"}) {
    const Json any = parse_json(text);
    const WhatCulpritSays said{any, any, any, any, {any, any}};
    EXPECT_EQ(verdict_of(said), Verdict::kNotWell) << text;
    all_of(said);
  }
}

TEST(StatusReport, LetsNoNameSteerTheTerminal) {
  WhatCulpritSays said = ill();
  said.state["incidents"][0]["headline"] = "\033[2J\u009b2Jcamera\n";
  said.state["overview"]["headline"] = "\033[2J";
  EXPECT_THAT(all_of(said), Not(HasSubstr("\033")));
  EXPECT_THAT(all_of(said), HasSubstr("\\x1b[2J\\x9b2Jcamera\\x0a"));
}

TEST(TerminalScreen, CutsLinesAtItsEdge) {
  EXPECT_EQ(cut_to("camera", 3), "cam");
  EXPECT_EQ(cut_to("äöü", 2), "äö");
  EXPECT_EQ(cut_to("\033[1;31mcamera\033[0m is", 3), "\033[1;31mcam");
  EXPECT_EQ(cut_to("short", 80), "short");
  EXPECT_EQ(cut_to("\033[", 80), "\033[");
}

}  // namespace
}  // namespace culprit::cli
