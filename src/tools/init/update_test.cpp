#include "init/update.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "init/marks.h"
#include "init/measures.h"
#include "language/checker.h"
#include "language/formatter.h"

namespace culprit::init {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

void put(RobotProfile& seen, const std::string& node, const std::string& topic, Duration longest) {
  seen.robot.nodes[node] = {.parameters = {}, .lifecycle = "", .pid = 10};
  seen.robot.nodes[node].pid += static_cast<int>(seen.robot.nodes.size());
  seen.starts[node].command = {"/opt/driver", node};
  seen.robot.topics[topic].type = "sensor_msgs/msg/LaserScan";
  seen.robot.topics[topic].publishers = {node};
  seen.rhythms[topic] = {301, 30s, longest};
}

RobotProfile two_lidars() {
  RobotProfile seen;
  seen.looked = 30s;
  put(seen, "/front", "/front/scan", 110ms);
  put(seen, "/back", "/back/scan", 110ms);
  seen.statuses[{"battery", ""}] = {30, 0, {}};
  return seen;
}

std::string file_of(const RobotProfile& seen) {
  const auto text = format({"draft", draft(seen)});
  EXPECT_TRUE(text) << text.error();
  return *text;
}

struct Updated {
  std::string text;
  std::vector<std::string> notes;
};

Updated updated(const std::string& text, const RobotProfile& seen, Packs packs = Packs::kNone) {
  const Checked before = check(expand({"before", text}));
  if (!before.rules) throw std::runtime_error(text);
  const Update update = init::update(text, *before.rules, seen, packs);
  std::string after;
  std::size_t line = 0;
  std::size_t at = 0;
  const auto pass = [&](std::size_t end, bool kept) {
    for (; line < end; ++line) {
      const std::size_t next = text.find('\n', at) + 1;
      if (kept) after += text.substr(at, next - at);
      at = next;
    }
  };
  for (const Update::Change& change : update.changes) {
    pass(change.at, true);
    pass(change.at + change.removed, false);
    for (const std::string& each : change.added) after += each;
  }
  pass(static_cast<std::size_t>(std::ranges::count(text, '\n')), true);
  if (packs == Packs::kNone) {
    EXPECT_THAT(check(expand({"after", after}), Strictness::kStrict).diagnostics, IsEmpty())
        << after;
  }
  return {after, update.notes};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("no " + from + " in " + text);
  return text.replace(at, from.size(), to);
}

TEST(Update, OfARobotThatIsTheSameIsNothing) {
  const std::string text = file_of(two_lidars());
  const Updated same = updated(text, two_lidars());
  EXPECT_EQ(same.text, text);
  EXPECT_THAT(same.notes, IsEmpty());
}

TEST(Update, SlightlyOtherPausesAreNoChange) {
  RobotProfile seen = two_lidars();
  seen.rhythms["/front/scan"].longest_pause = 210ms;
  seen.rhythms["/back/scan"].longest_pause = 80ms;
  const std::string text = file_of(two_lidars());
  EXPECT_EQ(updated(text, seen).text, text);
}

TEST(Update, ANewNodeAndANewDiagnosticAreAddedAndTheNextTimeAreThere) {
  RobotProfile seen = two_lidars();
  put(seen, "/left", "/left/scan", 110ms);
  seen.statuses[{"motor", ""}] = {30, 0, {}};
  const std::string before = file_of(two_lidars());
  const Updated now = updated(before, seen);
  EXPECT_THAT(now.text,
              AllOf(HasSubstr("\nCOMPONENT left NODE /left LAUNCH \"/opt/driver /left\"\n"),
                    HasSubstr("\nRULE left_failed\n"), HasSubstr("level(motor) >= 2\n")));
  EXPECT_EQ(updated(now.text, seen).text, now.text);
  const auto laid_out = format({"now", now.text});
  ASSERT_TRUE(laid_out);
  EXPECT_EQ(updated(*laid_out, seen).text, *laid_out) << "a layout is no change";
}

TEST(Update, WhatADraftWroteIsReplacedIfItNoLongerFits) {
  RobotProfile seen = two_lidars();
  seen.starts["/front"].command = {"/opt/new_driver", "/front"};
  seen.rhythms["/back/scan"] = {31, 30s, 1100ms};
  const Updated now = updated(file_of(two_lidars()), seen);
  EXPECT_THAT(
      now.text,
      AllOf(HasSubstr("LAUNCH \"/opt/new_driver /front\"\n"),
            Not(HasSubstr("LAUNCH \"/opt/driver /front\"")), HasSubstr("age(/back/scan) > 5s\n"),
            HasSubstr("# guess: /back/scan had 1 Hz"), Not(HasSubstr("/back/scan had 10 Hz"))));
  EXPECT_EQ(updated(now.text, seen).text, now.text);
}

TEST(Update, ATopicThatANodeHasNowIsWatched) {
  RobotProfile seen = two_lidars();
  put(seen, "/front", "/front/imu", 110ms);
  seen.robot.nodes["/front"].pid = 99;
  EXPECT_THAT(updated(file_of(two_lidars()), seen).text,
              HasSubstr("|| age(/front/imu) > 500ms || age(/front/scan) > 500ms"));
}

TEST(Update, WhatAPersonChangedOrTookAwayStaysAsItIs) {
  RobotProfile seen = two_lidars();
  const std::string draft = file_of(seen);
  std::string mine = replaced(draft, "age(/back/scan) > 500ms", "age(/back/scan)  >  9s # slow!");
  mine = replaced(mine, "LAUNCH \"/opt/driver /front\"", "LAUNCH \"/opt/driver /front --mine\"");
  const std::size_t rule = mine.find("# guess: battery");
  mine.erase(rule, mine.find("\n\n", rule) + 2 - rule);
  EXPECT_EQ(updated(mine, seen).text, mine);
  seen.rhythms["/back/scan"] = {31, 30s, 1100ms};
  EXPECT_EQ(updated(mine, seen).text, mine) << "also if the robot is another one by now";
  EXPECT_THAT(
      updated(mine, seen).notes,
      ElementsAre("front runs as `/opt/driver /front`, and not as its LAUNCH says, which stays"));
}

TEST(Update, OfAFileThatAPersonWroteAddsWhatItDoesNotName) {
  const std::string mine = R"(ROBOT mine
CYCLE   100ms
COMPONENT lidar_in_front NODE /front LAUNCH "/opt/mine"
COMPONENT gone LAUNCH "/opt/gone"
TEMPLATE t(name)
  COMPONENT {name} NODE /{name}
END
RULE Mine
  POLICIES ERROR
  TRIGGER level(battery) > 0 || !alive(gone)
    STRATEGY s 50 5
      ADAPTATION lidar_in_front redeploy 10
)";
  const Updated now = updated(mine, two_lidars());
  EXPECT_THAT(now.text,
              testing::StartsWith(replaced(mine.substr(0, mine.find("TEMPLATE")), "gone\"\n",
                                           "gone\"\nCOMPONENT back NODE /back LAUNCH "
                                           "\"/opt/driver /back\"\n")));
  EXPECT_THAT(now.text, AllOf(HasSubstr("RULE back_failed\n"), Not(HasSubstr("front_failed")),
                              Not(HasSubstr("battery_error")), HasSubstr("\n# marks ")));
  EXPECT_THAT(now.notes, ElementsAre("lidar_in_front runs as `/opt/driver /front`, and not as its "
                                     "LAUNCH says, which stays",
                                     "gone is not there now; its lines in the file stay"));
}

TEST(Update, ANodeThatIsGoneMayOnlyBeIllSoItsLinesStay) {
  RobotProfile seen = two_lidars();
  const std::string text = file_of(seen);
  seen.robot.nodes.erase("/front");
  seen.starts.erase("/front");
  seen.robot.topics.erase("/front/scan");
  const Updated now = updated(text, seen);
  EXPECT_EQ(now.text, text);
  EXPECT_THAT(now.notes, ElementsAre("front is not there now; its lines in the file stay"));
}

TEST(Update, ANewNodeHasAFreeName) {
  RobotProfile seen = two_lidars();
  put(seen, "/robot/front", "/other/scan", 110ms);
  EXPECT_THAT(updated(file_of(two_lidars()), seen).text,
              AllOf(HasSubstr("COMPONENT robot_front NODE /robot/front"),
                    HasSubstr("COMPONENT front  NODE /front")));
}

// ---- proposals

RobotProfile with_motor(double least, double most) {
  RobotProfile seen = two_lidars();
  link::StatusCourse& motor = seen.statuses[{"motor", ""}];
  motor.messages = 30;
  for (int i = 0; i < 30; ++i) motor.keys["temperature"].note(i % 2 == 0 ? least : most);
  return seen;
}

TEST(Update, AProposalIsReplacedIfWhatWasSeenNowIsNotWithinItOrASmallPartOfIt) {
  const std::string text = file_of(with_motor(60, 64));
  EXPECT_EQ(updated(text, with_motor(61, 66)).text, text) << "that is chance";
  for (const auto& [least, most] :
       {std::pair(60.0, 80.0), std::pair(20.0, 64.0), std::pair(62.0, 62.5)}) {
    const Updated now = updated(text, with_motor(least, most));
    EXPECT_THAT(now.text, AllOf(HasSubstr("# proposal: temperature of motor was " +
                                          as_number(least) + " to " + as_number(most)),
                                Not(HasSubstr("was 60 to 64"))));
    EXPECT_EQ(updated(now.text, with_motor(least, most)).text, now.text);
  }
}

TEST(Update, WhatWasNotThereIsProposed) {
  const std::string text = file_of(two_lidars());
  RobotProfile seen = with_motor(60, 64);
  seen.robot.topics["/cmd_vel"].type = "geometry_msgs/msg/Twist";
  const Updated now = updated(text, seen);
  EXPECT_THAT(now.text, AllOf(HasSubstr("\n# proposal: temperature of motor was 60 to 64"),
                              HasSubstr("\n#   INTERLOCK age(/cmd_vel) > 1s")));
  EXPECT_EQ(updated(now.text, seen).text, now.text);
  seen.fields["/cmd_vel"]["linear.x"] = {40, 0, -0.5, 0.25, 0, true, true};
  EXPECT_THAT(updated(now.text, seen).text, HasSubstr("40 commands came, at most 0.5"));
  seen.robot.topics["/arm/cmd_vel"].type = "geometry_msgs/msg/Twist";
  EXPECT_THAT(updated(now.text, seen).text, HasSubstr("#   INTERLOCK age(/arm/cmd_vel) > 1s"));
}

TEST(Update, AProposalThatAPersonTookOrTookAwayIsTheirs) {
  const std::string text = file_of(with_motor(60, 64));
  const std::size_t at = text.find("# proposal: temperature");
  ASSERT_NE(at, std::string::npos);
  const std::size_t end = text.find("\n\n", at);
  const std::string without = text.substr(0, at) + text.substr(end + 2);
  EXPECT_EQ(updated(without, with_motor(20, 90)).text, without);
  std::string taken = text;
  for (std::size_t line = taken.find("#   ", at); line < taken.find("\n\n", at);
       line = taken.find("#   ", line))
    taken.replace(line, 4, "");
  EXPECT_EQ(updated(taken, with_motor(20, 90)).text, taken);
}

TEST(Update, OfWhatAPersonsFileReadsAlreadyNothingIsProposed) {
  const std::string mine = R"(COMPONENT lidar_in_front NODE /front LAUNCH "/opt/driver /front"
COMPONENT back NODE /back LAUNCH "/opt/driver /back"
SIGNAL heat DIAGNOSTIC motor KEY temperature STALE 5s
INTERLOCK age(/cmd_vel) > 1s
RULE Mine
  POLICIES ERROR
  TRIGGER level(battery) > 0 || heat > 90
    STRATEGY s 50 5
      ADAPTATION lidar_in_front redeploy 10
        ADAPTATION back redeploy 10
)";
  RobotProfile seen = with_motor(60, 64);
  seen.robot.topics["/cmd_vel"].type = "geometry_msgs/msg/Twist";
  EXPECT_THAT(updated(mine, seen).text, Not(HasSubstr("# proposal")));
}

// ---- what was left out

TEST(Update, WhatIsLeftOutNowIsListedAndNothingOfWhatTheFileDeclares) {
  RobotProfile seen = two_lidars();
  seen.robot.nodes["/far"] = {};
  const Updated now = updated(file_of(two_lidars()), seen);
  EXPECT_THAT(now.text, HasSubstr("\n# /far: its process is not on this machine"));
  EXPECT_EQ(updated(now.text, seen).text, now.text);

  seen.robot.nodes["/farther"] = {};
  seen.robot.nodes["/front"].pid = 0;
  const Updated later = updated(now.text, seen);
  EXPECT_THAT(later.text, AllOf(HasSubstr("\n# /far: "), HasSubstr("\n# /farther: "),
                                Not(HasSubstr("# /front: "))));

  const Updated over = updated(now.text, two_lidars());
  EXPECT_EQ(over.text, file_of(two_lidars())) << "nothing is left out any more";
}

TEST(Update, WhyATopicHasNoRhythmIsNoChange) {
  RobotProfile seen = two_lidars();
  seen.rhythms["/back/scan"] = {4, 30s, 4s};
  const std::string text = file_of(seen);
  EXPECT_THAT(text, HasSubstr("# /back/scan: 4 messages came"));
  for (const link::Rhythm& other : {link::Rhythm{5, 30s, 4s}, link::Rhythm{100, 30s, 20s}}) {
    seen.rhythms["/back/scan"] = other;
    EXPECT_EQ(updated(text, seen).text, text);
  }
}

TEST(Update, AListThatAPersonChangedStaysAndWhatItLacksIsTold) {
  RobotProfile seen = two_lidars();
  seen.robot.nodes["/far"] = {};
  seen.robot.nodes["/near"] = {};
  const std::string mine =
      replaced(file_of(seen), "# /near: its process", "# /near: I know; its process");
  seen.robot.nodes["/new"] = {};
  const Updated now = updated(mine, seen);
  EXPECT_EQ(now.text, mine);
  EXPECT_THAT(now.notes,
              ElementsAre(testing::StartsWith(
                  "left out, and not in the list of the file: /new: its process is not")));
}

// ---- launch dumps

RobotProfile with_container(bool has_dump) {
  RobotProfile seen = two_lidars();
  for (const char* node : {"/box", "/camera"}) {
    seen.robot.nodes[node] = {.parameters = {}, .lifecycle = "", .pid = 77};
    seen.starts[node].command = {"/opt/component_container"};
  }
  seen.robot.services["/box/_container/load_node"] = "composition_interfaces/srv/LoadNode";
  if (!has_dump) return seen;
  seen.has_dump = true;
  seen.dump.recipes["/camera"] = {"/box", "cameras", "cameras::Driver", {{"rate", "10"}}, {}};
  seen.dump.respawned = {"/front"};
  seen.parameter_file = "/rules/my.params.yaml";
  return seen;
}

TEST(Update, ALaunchDumpSaysHowNodesAreLoadedAsInADraft) {
  const Updated now = updated(file_of(with_container(false)), with_container(true));
  EXPECT_THAT(now.text,
              AllOf(HasSubstr("COMPONENT camera NODE /camera IN /box PLUGIN cameras::Driver "
                              "PARAMETERS \"/rules/my.params.yaml\"\n"),
                    HasSubstr("COMPONENT box NODE /box LAUNCH \"/opt/component_container\"\n"),
                    HasSubstr("LAUNCH \"/opt/driver /front\" RESPAWNED\n"),
                    Not(HasSubstr("# /camera: it lives in"))));
  EXPECT_EQ(updated(now.text, with_container(true)).text, now.text);
}

TEST(Update, WithoutADumpNothingIsLostThatOneSaid) {
  const std::string text = file_of(with_container(true));
  EXPECT_EQ(updated(text, with_container(false)).text, text);
  RobotProfile seen = with_container(false);
  seen.starts["/front"].command = {"/opt/new_driver", "/front"};
  EXPECT_THAT(updated(text, seen).text, HasSubstr("LAUNCH \"/opt/new_driver /front\" RESPAWNED\n"));
}

TEST(Update, ADumpThatSaysOtherwiseCounts) {
  RobotProfile seen = with_container(true);
  seen.dump.respawned = {"/back"};
  seen.dump.recipes["/camera"].plugin = "cameras::NewDriver";
  const Updated now = updated(file_of(with_container(true)), seen);
  EXPECT_THAT(now.text,
              AllOf(HasSubstr("PLUGIN cameras::NewDriver"), Not(HasSubstr("cameras::Driver ")),
                    HasSubstr("LAUNCH \"/opt/driver /back\" RESPAWNED\n"),
                    Not(HasSubstr("LAUNCH \"/opt/driver /front\" RESPAWNED"))));
}

TEST(Update, ParametersOfWhichTheDumpSaysNothingNowStay) {
  const RobotProfile before = with_container(true);
  const std::string file = parameters_text(before);
  EXPECT_TRUE(is_as_written(file));
  EXPECT_EQ(parameters_text(before, file), file);
  RobotProfile seen = with_container(true);
  seen.robot.nodes.erase("/camera");
  seen.robot.nodes["/depth"] = seen.robot.nodes["/box"];
  seen.dump.recipes["/depth"] = {"/box", "cameras", "cameras::Depth", {{"range", "4"}}, {}};
  const std::string now = parameters_text(seen, file);
  EXPECT_THAT(now, AllOf(HasSubstr("/camera:\n  ros__parameters:\n    \"rate\": 10\n"),
                         HasSubstr("/depth:\n  ros__parameters:\n    \"range\": 4\n")));
  EXPECT_TRUE(is_as_written(now));
}

TEST(Update, WithPacksANewDriverHasItsPackAndAnOldOneItsRule) {
  RobotProfile seen = two_lidars();
  for (const char* node : {"/back", "/left"}) {
    put(seen, node, std::string(node) + "/scan", 110ms);
    seen.starts[node].command = {"/opt/lib/urg_node2/urg_node2", node};
  }
  const std::string before = replaced(file_of(two_lidars()), "/opt/driver /back", "/x/y /back");
  const Updated now = updated(before, seen, Packs::kChosen);
  EXPECT_THAT(now.text, AllOf(HasSubstr("\nINCLUDE \"packs/lidars.rules\"\n"),
                              HasSubstr("\nUSE urg_node2(left, /left/scan, 10)\n"),
                              Not(HasSubstr("USE urg_node2(back")), Not(HasSubstr("left_failed"))));
  EXPECT_LT(now.text.find("INCLUDE"), now.text.find("COMPONENT"));
}

TEST(Marks, OfAWholeFileTellWhetherSomebodyChangedIt) {
  const std::string file = with_mark("/a:\n  b: 1\n");
  EXPECT_TRUE(is_as_written(file));
  EXPECT_FALSE(is_as_written(replaced(file, "  b", "    b"))) << "in YAML layout is meaning";
  EXPECT_FALSE(is_as_written(file + "\n"));
  EXPECT_FALSE(is_as_written("/a:\n  b: 1\n"));
  EXPECT_FALSE(is_as_written(""));
}

TEST(Marks, ThatADiskOrAPersonDamagedAreNone) {
  EXPECT_THAT(marks_in("# marks 0000000a0000000b 12 zzzzzzzzzzzzzzzz 0000000c0000000d"),
              ElementsAre(Mark{10, 11}, Mark{12, 13}));
  EXPECT_FALSE(is_of_marks("# marksman 0000000a0000000b"));
}

}  // namespace
}  // namespace culprit::init
