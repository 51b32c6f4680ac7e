// Checks the messages to readers while a robot is healed, in virtual time.
#include "ros_api/teller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "manager/test_robot.h"
#include "ros_api/message_codec.h"

namespace culprit::ros_api {
namespace {

using namespace std::chrono_literals;
using test::TestRobot;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const std::string kToldRules = test::rules_of_camera_and_lamp("ROBOT rover\n");

struct ToldRobot {
  explicit ToldRobot(Manager::Options options = {}) {
    robot.emplace(kToldRules, std::make_unique<BayesPlanner>(), options);
    test::add_camera_and_lamp(*robot);
    teller.begins(
        robot->manager(), [this] { return remarks; }, Time());
    robot->before_commands = [this](std::vector<Observation>& observations,
                                    std::span<const Command> commands) {
      teller.stepped({robot->now, {}, observations, commands, robot->manager().events()});
      return true;
    };
    robot->discover();
    robot->signal("brightness", Value(1.0));
    run_for(8s);
  }
  // The manager is stepped when it wants to be, and when the teller does.
  void run_for(Duration time) {
    for (const Time end = robot->now + time; robot->now < end;) {
      robot->run_for(std::min<Duration>(50ms, end - robot->now));
      std::vector<Observation> none;
      if (teller.next_look() <= robot->now) teller.stepped({robot->now, {}, none, {}, {}});
    }
  }
  int constant(const char* type, const char* name) const {
    return types.constant("culprit_msgs/msg/" + std::string(type), name);
  }
  std::vector<int> kinds() const {
    std::vector<int> all;
    for (const Json& each : decisions) all.push_back(each["kind"]);
    return all;
  }
  std::vector<int> states() const {
    std::vector<int> all;
    for (const Json& each : incidents) all.push_back(each["state"]);
    return all;
  }
  void clear() {
    statuses.clear();
    incidents.clear();
    decisions.clear();
  }

  const CulpritTypes types;
  live::Observer::Remarks remarks;
  std::vector<Json> statuses;
  std::vector<Json> incidents;
  std::vector<Json> decisions;
  std::optional<TestRobot> robot;
  Teller teller{
      types, "1.2.3",
      [this](Topic topic, const Json& message) {
        const char* const names[] = {"Status", "Incident", "Decision"};
        const auto place = static_cast<std::size_t>(topic);
        const auto payload =
            encode(message, types.message("culprit_msgs/msg/" + std::string(names[place])));
        EXPECT_TRUE(payload) << payload.error();
        (place == 0 ? statuses : place == 1 ? incidents : decisions).push_back(message);
      },
      [this] {
        return WallTime(std::chrono::seconds(1795538700)) +
               std::chrono::duration_cast<WallTime::duration>(robot->now.time_since_epoch());
      }};
};

TEST(Teller, NeverSaysThatAllIsWellWhileARuleIsBlind) {
  ToldRobot told;
  for (int i = 0; i < 10; ++i) {
    told.robot->signal("brightness", Value(1.0));
    told.run_for(1s);
  }
  told.run_for(60s);
  EXPECT_EQ(told.statuses.back()["summary"], "no failure is seen, but Dark is blind");
}

TEST(Teller, ReportsTheNodesAndThatAllIsWell) {
  const ToldRobot told;
  ASSERT_THAT(told.statuses, testing::Not(IsEmpty()));
  const Json& status = told.statuses.back();
  EXPECT_EQ(status["robot"], "rover");
  EXPECT_EQ(status["version"], "1.2.3");
  EXPECT_EQ(status["summary"], "all is well");
  EXPECT_EQ(status["health"], told.constant("Component", "HEALTH_OK"));
  EXPECT_EQ(status["is_paused"], false);
  EXPECT_EQ(status["hears"], true);
  ASSERT_THAT(status["components"], SizeIs(3));
  const Json& camera = status["components"][0];
  EXPECT_EQ(camera["name"], "camera");
  EXPECT_EQ(camera["node"], "/camera");
  EXPECT_EQ(camera["process"], told.constant("Component", "PROCESS_RUNNING"));
  EXPECT_EQ(camera["is_present"], true);
  EXPECT_THAT(told.incidents, IsEmpty());
  EXPECT_THAT(told.decisions, IsEmpty());
}

TEST(Teller, SaysNothingWhileNothingChanges) {
  ToldRobot told;
  told.clear();
  told.run_for(10min);
  EXPECT_THAT(told.statuses, IsEmpty());
  EXPECT_EQ(told.teller.next_look(), kNever) << "and it needs no step of its own";
}

TEST(Teller, TellsAnIncidentFromItsBeginningToItsEnd) {
  ToldRobot told;
  told.clear();
  told.robot->kill("camera");
  told.run_for(1min);
  ASSERT_TRUE(told.robot->works("camera") && told.robot->works("fusion"));
  ASSERT_THAT(told.incidents, SizeIs(testing::Ge(2u)));
  const Json& first = told.incidents.front();
  EXPECT_EQ(first["state"], told.constant("Incident", "STATE_OPEN"));
  EXPECT_EQ(first["rule"], "CameraSilent");
  EXPECT_EQ(first["components"], Json({"camera"}));
  EXPECT_EQ(first["health"], told.constant("Component", "HEALTH_ERROR"));
  EXPECT_THAT(first["headline"].get<std::string>(), HasSubstr("camera"));
  for (const Json& each : told.incidents) EXPECT_EQ(each["id"], first["id"]) << each;
  const Json& last = told.incidents.back();
  EXPECT_EQ(last["state"], told.constant("Incident", "STATE_RESOLVED"));
  EXPECT_EQ(last["consequences"], Json({"FusionSilent"})) << "it fails because of it";
  const auto time_of = [](const Json& stamp) {
    return std::pair(stamp["sec"].get<int>(), stamp["nanosec"].get<int>());
  };
  EXPECT_GT(time_of(last["stamp"]), time_of(last["since"]));
  EXPECT_EQ(told.statuses.back()["summary"], "all is well");
  EXPECT_THAT(told.statuses.back()["incidents"], IsEmpty());
}

TEST(Teller, TellsWhatWasDecidedAndWhy) {
  ToldRobot told;
  told.clear();
  told.robot->kill("camera");
  told.run_for(1min);
  ASSERT_THAT(told.kinds(), testing::Contains(told.constant("Decision", "KIND_BEGUN")));
  const auto begun = std::ranges::find_if(told.decisions, [&](const Json& each) {
    return each["kind"] == told.constant("Decision", "KIND_BEGUN");
  });
  EXPECT_EQ((*begun)["rule"], "CameraSilent");
  EXPECT_EQ((*begun)["strategy"], "redeploy_camera");
  EXPECT_EQ((*begun)["components"], Json({"camera"}));
  ASSERT_THAT((*begun)["candidates"], SizeIs(1));
  EXPECT_EQ((*begun)["candidates"][0]["is_chosen"], true);
  EXPECT_EQ((*begun)["candidates"][0]["actions"], Json({"redeploy camera"}));
  EXPECT_GT((*begun)["candidates"][0]["resolves"], 0.5);
  EXPECT_THAT((*begun)["text"].get<std::string>(), HasSubstr("redeploy camera"));
  EXPECT_THAT(told.kinds(), testing::Contains(told.constant("Decision", "KIND_SUCCEEDED")));
}

TEST(Teller, AsksForApproval) {
  Manager::Options options;
  options.governor.approval = Approval::kEach;
  ToldRobot told(options);
  told.robot->kill("camera");
  told.run_for(5s);
  EXPECT_THAT(told.kinds(), testing::Contains(told.constant("Decision", "KIND_ASKED")));
  ASSERT_THAT(told.statuses.back()["asked"], SizeIs(1));
  EXPECT_EQ(told.statuses.back()["asked"][0]["rule"], "CameraSilent");
  EXPECT_EQ(told.statuses.back()["asked"][0]["name"], "redeploy_camera");
  EXPECT_EQ(told.incidents.back()["needs_person"], true);
}

TEST(Teller, TellsWhatPeopleHaveOrdered) {
  ToldRobot told;
  told.clear();
  told.robot->order({1, "ann", "", Pause{}});
  told.robot->order({2, "ann", "", Silence{told.robot->id("camera")}});
  told.robot->order({3, "ann", "", Silence{RuleId(2)}});
  told.run_for(1s);
  const Json& status = told.statuses.back();
  EXPECT_EQ(status["is_paused"], true);
  EXPECT_THAT(status["summary"].get<std::string>(), HasSubstr("[paused]"));
  EXPECT_EQ(status["components"][0]["is_silenced"], true);
  EXPECT_EQ(status["components"][1]["is_silenced"], false);
  EXPECT_EQ(status["silenced_rules"], Json({"Dark"}));
  told.robot->order({4, "ann", "", Resume{}});
  told.run_for(1s);
  EXPECT_EQ(told.statuses.back()["is_paused"], false);
}

TEST(Teller, SaysThatNothingIsLeftToTry) {
  ToldRobot told;
  (*told.robot)["camera"].dies_at_start = true;
  told.robot->kill("camera");
  told.run_for(10min);
  EXPECT_THAT(told.kinds(), testing::Contains(told.constant("Decision", "KIND_EXHAUSTED")));
  EXPECT_EQ(told.statuses.back()["health"], told.constant("Component", "HEALTH_EXHAUSTED"));
  EXPECT_EQ(told.incidents.back()["needs_person"], true);
}

// A flood on the robot is none of messages.
TEST(Teller, TellsAFewTimesASecondAtMost) {
  ToldRobot told;
  told.clear();
  const Time begin = told.robot->now;
  for (int i = 0; i < 500; ++i) {
    told.robot->tell(NodeAppeared{"/camera", 1000 + i});
    told.robot->tell(
        ProcessSeen{told.robot->id("camera"), ProcessState::kGone, 1000 + i, "", Cause::kWish},
        2ms);
  }
  const double seconds_gone = seconds(told.robot->now - begin);
  EXPECT_LE(told.statuses.size(),
            1 + seconds_gone * seconds(Duration(1s)) / seconds(Teller::kPeriod));
}

TEST(Teller, WhereManyThingsAreDecidedAtOnceItSaysHowManyItLeftOut) {
  ToldRobot told;
  told.clear();
  const auto flood = [&](int count) {
    std::vector<Event> events;
    for (int i = 0; i < count; ++i) events.push_back({told.robot->now, RuleExhausted{RuleId(0)}});
    std::vector<Observation> none;
    told.teller.stepped({told.robot->now, {}, none, {}, events});
  };
  flood(80);
  EXPECT_THAT(told.decisions, SizeIs(Teller::kMostDecisions));
  told.robot->now += 2s;
  flood(1);
  EXPECT_EQ(told.decisions.back()["left_out"], 80 - Teller::kMostDecisions);
  flood(1);
  EXPECT_EQ(told.decisions.back()["left_out"], 0);
}

TEST(Teller, ANewManagerKnowsOfNoIncidentUntilItSeesOne) {
  ToldRobot told;
  (*told.robot)["camera"].dies_at_start = true;
  told.robot->kill("camera");
  told.run_for(2s);
  ASSERT_THAT(told.statuses.back()["incidents"], SizeIs(1));
  const RuleSet rules = told.robot->rules();
  Manager next(rules, std::make_unique<BayesPlanner>(), {.start = told.robot->now});
  told.teller.begins(next, {}, Time());
  std::vector<Observation> none;
  (void)next.step(told.robot->now, none);
  told.teller.stepped({told.robot->now, {}, none, {}, next.events()});
  EXPECT_EQ(told.incidents.back()["state"], told.constant("Incident", "STATE_LOST"));
  EXPECT_THAT(told.statuses.back()["incidents"], IsEmpty());
}

TEST(Teller, ShowsOtherNodesOfTheSameName) {
  ToldRobot told;
  told.remarks["/fusion"] = "kill 12 or 13";
  told.robot->tell(NamesakesSeen{"/fusion", 1});
  told.run_for(1s);
  EXPECT_EQ(told.statuses.back()["components"][1]["remark"], "kill 12 or 13");
}

}  // namespace
}  // namespace culprit::ros_api
