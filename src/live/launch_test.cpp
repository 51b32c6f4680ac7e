#include "live/launch.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "language/checker.h"
#include "robot/component_binding.h"

namespace culprit::live {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct ScriptedNode {
  Duration start = 2s;        // from the launch until it is in the graph
  Duration services_after{};  // until its lifecycle services are
  bool has_lifecycle = true;
  Duration activates_itself_after{};  // being there; 0: it does not
  bool refuses = false;
  bool loses_replies = false;
  bool has_no_program = false;
  bool crashes = false;  // instead of coming up
  Lifecycle state = Lifecycle::kUnconfigured;
};

// Virtual time; nodes that come up as scripted, and record their requests.
class ScriptedRobot : public Robot {
 public:
  explicit ScriptedRobot(const RuleSet& rules) : rules_(rules) {}

  Time now() const override { return now_; }
  void observe(Time until, std::vector<Observation>& observations) override {
    const bool comes = !agenda_.empty() && agenda_.begin()->first <= until;
    now_ = std::max(now_, comes ? agenda_.begin()->first : until);
    if (!comes) return;
    auto happens = agenda_.begin()->second;
    agenda_.erase(agenda_.begin());
    happens(observations);
  }
  void execute(const Command& command) override {
    ScriptedNode& node = nodes[rules_[command.component].name];
    Reply reply{command.id, Outcome::kDone, {}, ""};
    if (const auto* change = std::get_if<ChangeLifecycle>(&command.what)) {
      const bool up = change->transition == Transition::kActivate;
      asked.push_back((up ? "activate " : "configure ") + rules_[command.component].name);
      if (node.refuses) {
        reply.outcome = Outcome::kRefused;
        reply.text = "no calibration";
      } else {
        node.state = up ? Lifecycle::kActive : Lifecycle::kInactive;
      }
      if (node.loses_replies) reply.outcome = Outcome::kTimedOut;
    } else {
      reply.value = node.state;
      in(0ms, [=, this, state = node.state](auto& out) {
        out.push_back({now_, LifecycleRead{command.component, state}});
      });
    }
    const Duration takes = reply.outcome == Outcome::kTimedOut ? command.timeout : Duration(1ms);
    in(takes, [=, this](auto& out) { out.push_back({now_, reply}); });
  }
  void start(CommandId command, ComponentId component) {
    const Component& what = rules_[component];
    ScriptedNode& node = nodes[what.name];
    started.push_back(what.name);
    if (node.has_no_program)
      return in(1ms, [=, this](auto& out) {
        out.push_back({now_, Reply{command, Outcome::kUnreachable, {}, "no such program"}});
      });
    if (node.crashes)
      return in(node.start, [=, this](auto& out) {
        out.push_back({now_, ProcessSeen{component, ProcessState::kGone, 7, "exit code 1"}});
      });
    in(node.start, [=, this](auto& out) { appear(what.node, component, out); });
    if (node.activates_itself_after > 0s)
      in(node.start + node.activates_itself_after, [=, this](auto& out) {
        nodes[what.name].state = Lifecycle::kActive;
        out.push_back({now_, LifecycleRead{component, Lifecycle::kActive}});
      });
  }
  void appear(const std::string& node, ComponentId component, std::vector<Observation>& out) {
    out.push_back({now_, NodeAppeared{node, 7}});
    ScriptedNode& it = nodes[rules_[component].name];
    if (!it.has_lifecycle) return;
    in(it.services_after / 2, [=, this](auto& later) {
      later.push_back(
          {now_, EndpointAppeared{node, EndpointKind::kServer, node + "/get_parameters"}});
    });
    in(it.services_after, [=, this](auto& later) {
      later.push_back(
          {now_, EndpointAppeared{node, EndpointKind::kServer, node + "/change_state"}});
      later.push_back({now_, LifecycleRead{component, nodes[rules_[component].name].state}});
    });
  }
  template <class Happens>
  void in(Duration after, Happens happens) {
    agenda_.emplace(now_ + after, happens);
  }

  std::map<std::string, ScriptedNode> nodes;
  std::vector<std::string> started, asked;

 private:
  const RuleSet& rules_;
  Time now_{1h};
  std::multimap<Time, std::function<void(std::vector<Observation>&)>> agenda_;
};

struct Remarks : Listener {
  void on_remark(const std::string& lines) override { text += lines; }
  std::string text;
};

class Launching : public testing::Test {
 protected:
  explicit Launching(const std::string& lidar = "")
      : rules_(*check(Source("launch.rules",
                             "COMPONENT planner NODE /planner LAUNCH \"planner\"\n"
                             "COMPONENT lidar NODE /lidar LAUNCH \"lidar\" " +
                                 lidar +
                                 "\nCOMPONENT map NODE /map\n"
                                 "DEPENDENCY planner ON lidar\n"))
                    .rules),
        robot(rules_) {}

  void launch_all() {
    launched = launch(
        robot, rules_, [&](CommandId command, ComponentId c) { robot.start(command, c); }, remarks,
        stop, {}, keeper);
  }

 private:
  const RuleSet rules_;

 protected:
  ScriptedRobot robot;
  Remarks remarks;
  LaunchKeeper keeper;
  std::atomic<bool> stop = false;
  Launched launched;
};
struct LaunchingDriven : Launching {
  LaunchingDriven() : Launching("LIFECYCLE launcher") {}
};
struct LaunchingManaged : Launching {
  LaunchingManaged() : Launching("LIFECYCLE managed") {}
};

TEST_F(Launching, BringsUpWhatStandsStillProducersFirst) {
  launch_all();
  EXPECT_THAT(robot.started, ElementsAre("lidar", "planner"));
  EXPECT_THAT(robot.asked, ElementsAre("configure lidar", "activate lidar", "configure planner",
                                       "activate planner"));
  EXPECT_EQ(launched.parts.size(), 2u);
  EXPECT_THAT(remarks.text, testing::Not(HasSubstr("is not up")));
  std::size_t lifecycles = 0;
  for (const Observation& each : launched.seen) {
    EXPECT_FALSE(std::holds_alternative<Reply>(each.what)) << "the manager did not ask";
    if (const auto* read = std::get_if<LifecycleRead>(&each.what)) {
      EXPECT_EQ(read->state, Lifecycle::kActive);
      ++lifecycles;
    }
  }
  EXPECT_EQ(lifecycles, 2u);
  ASSERT_EQ(launched.past.size(), 2u);
  const auto& how = std::get<CameUp>(launched.past[0].what).how;
  EXPECT_EQ(how.driver, ComingUp::Driver::kCulprit);
  EXPECT_EQ(how.joining, 2s);
}

TEST_F(Launching, LeavesDownWhatStaysDown) {
  keeper.stay_down = {ComponentId(1u)};  // the lidar
  keeper.left = {{"lidar", true}};
  keeper.runs = [](ComponentId) { return true; };  // it is being ended
  launch_all();
  EXPECT_THAT(robot.started, ElementsAre("planner"));
  EXPECT_THAT(robot.asked, ElementsAre("configure planner", "activate planner"));
  EXPECT_EQ(launched.parts.size(), 1u);
  EXPECT_THAT(remarks.text,
              HasSubstr("culprit: lidar is not started: it stays down until `culprit revive`"));
}

TEST_F(Launching, LeavesANodeAloneThatActivatesItself) {
  robot.nodes["lidar"].activates_itself_after = 1900ms;  // less than its start took
  launch_all();
  ASSERT_EQ(launched.past.size(), 2u);
  const ComingUp lidar{ComingUp::Driver::kOther, 2s, 1900ms};
  EXPECT_EQ(std::get<CameUp>(launched.past[0].what).how, lidar);
  EXPECT_THAT(robot.asked, ElementsAre("configure planner", "activate planner"));
}

TEST_F(Launching, WaitsForANodeThatActivatedItselfBefore) {
  const auto came_up = [](ComponentId c, ComingUp how) { return Event{Time{}, CameUp{c, how}}; };
  keeper.past = {came_up(ComponentId(1u), {ComingUp::Driver::kOther, 2s, 4s}),
                 came_up(ComponentId(0u), {ComingUp::Driver::kCulprit, 2s, 1s})};
  robot.nodes["lidar"].activates_itself_after = 7s;
  const Time begin = robot.now();
  launch_all();
  EXPECT_THAT(robot.asked, ElementsAre("configure planner", "activate planner"));
  EXPECT_LT(robot.now() - begin, 13s) << "the planner is culprit's, and nobody is waited for";
}

// On a machine on which much starts at once.
TEST_F(Launching, WaitsForServicesThatComeOneAfterTheOther) {
  robot.nodes["lidar"].services_after = 1900ms;
  launch_all();
  EXPECT_EQ(robot.nodes["lidar"].state, Lifecycle::kActive);
}

TEST_F(Launching, DoesNotWaitForServicesOfANodeThatIsOnlySlow) {
  robot.nodes["lidar"] = {.start = 24s, .has_lifecycle = false};
  const Time begin = robot.now();
  launch_all();
  EXPECT_THAT(robot.asked, ElementsAre("configure planner", "activate planner"));
  EXPECT_LT(robot.now() - begin, 30s);
}

TEST_F(LaunchingManaged, WaitsForServicesThatTheFilePromises) {
  robot.nodes["lidar"].services_after = 9s;
  launch_all();
  EXPECT_EQ(robot.nodes["lidar"].state, Lifecycle::kActive);
  EXPECT_THAT(remarks.text, testing::Not(HasSubstr("is not up")));
}

TEST_F(LaunchingManaged, TellsThatANodeHasNotWhatTheFilePromisesAndGoesOn) {
  robot.nodes["lidar"].has_lifecycle = false;
  launch_all();
  EXPECT_THAT(remarks.text,
              HasSubstr("lidar was started and is not up: LIFECYCLE says that culprit brings it "
                        "up, but it offers no lifecycle services"));
  EXPECT_THAT(robot.asked, ElementsAre("configure planner", "activate planner"));
}

TEST_F(LaunchingDriven, LeavesANodeAloneThatTheFileGivesToOthers) {
  launch_all();
  EXPECT_THAT(robot.asked, ElementsAre("configure planner", "activate planner"));
}

TEST_F(Launching, LeavesANodeAloneThatIsInactiveOnPurpose) {
  robot.nodes["lidar"].state = Lifecycle::kInactive;
  launch_all();
  EXPECT_THAT(robot.asked, ElementsAre("configure planner", "activate planner"));
}

TEST_F(Launching, TouchesNothingThatRunsAlready) {
  robot.in(10ms, [this](auto& out) { robot.appear("/lidar", ComponentId(1u), out); });
  launch_all();
  EXPECT_THAT(robot.started, ElementsAre("planner"));
  EXPECT_THAT(robot.asked, ElementsAre("configure planner", "activate planner"));
}

TEST_F(Launching, ReportsANodeThatDidNotComeUpAndGoesOn) {
  robot.nodes["lidar"].refuses = true;
  launch_all();
  EXPECT_THAT(robot.asked, ElementsAre("configure lidar", "configure planner", "activate planner"));
  EXPECT_THAT(remarks.text, HasSubstr("lidar was started and is not up: to configure it did not "
                                      "succeed: no calibration"));
}

TEST_F(Launching, BelievesWhatItReadsBackAndNotALostReply) {
  robot.nodes["lidar"].loses_replies = true;
  launch_all();
  EXPECT_EQ(robot.nodes["lidar"].state, Lifecycle::kActive);
  EXPECT_THAT(remarks.text, testing::Not(HasSubstr("is not up")));
}

TEST_F(Launching, DoesNotWaitForWhatCrashedNorForEver) {
  const Time begin = robot.now();
  robot.nodes["lidar"].crashes = true;
  launch_all();
  EXPECT_THAT(robot.asked, ElementsAre("configure planner", "activate planner"));
  EXPECT_LT(robot.now() - begin, 20s);
  robot.nodes["planner"].start = 24h;
  const Time again = robot.now();
  launch_all();
  EXPECT_LT(robot.now() - again, 70s);
}

TEST_F(Launching, TellsWhatCannotBeStartedAndDoesNotWaitForIt) {
  const Time begin = robot.now();
  robot.nodes["lidar"].has_no_program = true;
  launch_all();
  EXPECT_THAT(remarks.text, HasSubstr("lidar was started and is not up: no such program"));
  EXPECT_LT(robot.now() - begin, 20s);
}

// One that hangs must not keep the manager from its work for as long as there are others.
TEST_F(Launching, BringsNobodyUpAnyMoreAfterAMinute) {
  robot.nodes["lidar"].start = 29s;
  robot.nodes["lidar"].loses_replies = true;
  launch_all();
  EXPECT_THAT(robot.asked, ElementsAre("configure lidar", "activate lidar"));
  EXPECT_THAT(remarks.text, HasSubstr("planner was started and is not up: there was no time left"));
}

// ---- after a culprit that was killed in the middle of it

TEST_F(Launching, KeepsWhatIsNotFinished) {
  std::vector<Unfinished> kept;
  keeper.keep = [&](const Unfinished& unfinished) { kept.push_back(unfinished); };
  launch_all();
  EXPECT_THAT(kept, ElementsAre(Unfinished{{"lidar", false}, {"planner", false}},
                                Unfinished{{"lidar", true}, {"planner", false}},
                                Unfinished{{"planner", false}}, Unfinished{{"planner", true}},
                                Unfinished{}));
}

TEST_F(Launching, BringsUpWhatAnEarlierCulpritHadStarted) {
  for (const bool launches : {false, true}) {
    robot.nodes["lidar"] = {};
    robot.nodes["planner"].state = Lifecycle::kActive;
    robot.asked.clear();
    robot.in(10ms, [this](auto& out) {
      robot.appear("/lidar", ComponentId(1u), out);
      robot.appear("/planner", ComponentId(0u), out);
    });
    keeper.left = {{"lidar", false}, {"nobody", true}};
    keeper.runs = [](ComponentId c) { return c == ComponentId(1u); };
    keeper.starts_missing = launches;
    launch_all();
    EXPECT_THAT(robot.started, IsEmpty());
    EXPECT_THAT(robot.asked, ElementsAre("configure lidar", "activate lidar"));
    EXPECT_THAT(remarks.text, HasSubstr("bringing up lidar"));
  }
}

// Its state is where culprit left it, and no intention of a person.
TEST_F(Launching, BringsUpWhatWasLeftHalfway) {
  robot.nodes["lidar"].state = Lifecycle::kInactive;
  robot.in(10ms, [this](auto& out) { robot.appear("/lidar", ComponentId(1u), out); });
  keeper.left = {{"lidar", true}};
  keeper.runs = [](ComponentId) { return true; };
  keeper.starts_missing = false;
  launch_all();
  EXPECT_THAT(robot.asked, ElementsAre("activate lidar"));
}

TEST_F(Launching, LeavesAloneWhatIsSomebodyElsesByNow) {
  robot.in(10ms, [this](auto& out) { robot.appear("/lidar", ComponentId(1u), out); });
  keeper.left = {{"lidar", true}, {"planner", false}};
  keeper.starts_missing = false;
  launch_all();
  EXPECT_THAT(robot.started, IsEmpty());
  EXPECT_THAT(robot.asked, IsEmpty());
}

TEST(Unfinished, IsReadAsItWasWritten) {
  const test::TestFolder folder;
  const auto path = launching_beside(folder.path() / "robot.journal");
  EXPECT_TRUE(read_unfinished(path).empty());
  const Unfinished unfinished{{"lidar", true}, {"planner", false}};
  ASSERT_TRUE(write_unfinished(path, unfinished));
  EXPECT_EQ(read_unfinished(path), unfinished);
  ASSERT_TRUE(write_unfinished(path, {}));
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(Launching, EndsWhenCulpritIsStopped) {
  stop = true;
  launch_all();
  EXPECT_THAT(robot.started, IsEmpty());
  EXPECT_THAT(robot.asked, IsEmpty());
}

}  // namespace
}  // namespace culprit::live
