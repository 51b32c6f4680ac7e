#include "ros_api/recovery_goals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::ros_api {
namespace {

using namespace std::chrono_literals;

using State = RecoveryGoals::State;

constexpr Time kNow = Time() + 100s;
constexpr WallTime kWall = WallTime() + 1000s;

RecoveryGoals::Id id_of(int number) {
  RecoveryGoals::Id id{};
  id[0] = static_cast<std::uint8_t>(number / 256);
  id[1] = static_cast<std::uint8_t>(number % 256);
  id[15] = 1;
  return id;
}

Json component_status(const std::string& name, int health = 0) {
  return {
      {"name", name}, {"health", health}, {"is_present", true}, {"process", 1}, {"adapting", ""}};
}

Json status_of(Json components) {
  int health = 0;
  for (const Json& each : components) health = std::max(health, each["health"].get<int>());
  return {{"hears", true},
          {"health", health},
          {"components", std::move(components)},
          {"incidents", Json::array()}};
}

const Json kWell = status_of({component_status("camera"), component_status("planner")});

Json with_ill_camera() {
  Json status = status_of({component_status("camera", 3), component_status("planner")});
  status["incidents"].push_back({{"components", {"camera"}},
                                 {"headline", "camera is down"},
                                 {"doing", "redeploy camera"},
                                 {"needs_person", false}});
  return status;
}

State state_of(const RecoveryGoals& goals, int number) { return goals.find(id_of(number))->state; }

TEST(RecoveryGoals, EndWhenTheComponentIsWell) {
  RecoveryGoals goals;
  goals.look(with_ill_camera());
  ASSERT_TRUE(goals.begin({id_of(1), "camera", 0s}, kNow, kWall));
  goals.look_again();
  EXPECT_EQ(state_of(goals, 1), State::kExecuting);
  EXPECT_THAT(goals.take_news(), testing::ElementsAre(id_of(1)));
  const Json expected{
      {"ill", {"camera"}}, {"doing", "camera is down: redeploy camera"}, {"needs_person", false}};
  EXPECT_EQ(goals.find(id_of(1))->feedback, expected);

  goals.look(with_ill_camera());
  EXPECT_THAT(goals.take_news(), testing::IsEmpty()) << "it is no news";
  goals.look(kWell);
  EXPECT_EQ(state_of(goals, 1), State::kSucceeded);
  EXPECT_EQ(goals.find(id_of(1))->result["message"], "camera is well");
  EXPECT_THAT(goals.take_ended(), testing::ElementsAre(id_of(1)));
  EXPECT_THAT(goals.take_ended(), testing::IsEmpty());
}

TEST(RecoveryGoals, OfAWellComponentEndAtOnceWhateverElseIsIll) {
  RecoveryGoals goals;
  goals.look(with_ill_camera());
  ASSERT_TRUE(goals.begin({id_of(1), "planner", 0s}, kNow, kWall));
  ASSERT_TRUE(goals.begin({id_of(2), "", 0s}, kNow, kWall));
  goals.look_again();
  EXPECT_EQ(state_of(goals, 1), State::kSucceeded);
  EXPECT_EQ(state_of(goals, 2), State::kExecuting) << "of the whole robot";
}

TEST(RecoveryGoals, TakeForNoRecoveryWhatIsNotKnown) {
  RecoveryGoals goals;
  ASSERT_TRUE(goals.begin({id_of(1), "camera", 0s}, kNow, kWall));
  ASSERT_TRUE(goals.begin({id_of(2), "", 0s}, kNow, kWall));
  goals.look_again();
  EXPECT_EQ(state_of(goals, 1), State::kExecuting) << "it has not been checked yet";
  Json deaf = kWell;
  deaf["hears"] = false;
  goals.look(deaf);
  EXPECT_EQ(state_of(goals, 1), State::kExecuting);
  EXPECT_EQ(state_of(goals, 2), State::kExecuting);
  EXPECT_EQ(goals.find(id_of(2))->feedback["doing"], "culprit receives nothing from the robot");

  for (const auto& [member, value] : std::map<std::string, Json>{
           {"is_present", false}, {"process", 2}, {"process", 4}, {"adapting", "restart"}}) {
    Json status = kWell;
    status["components"][0][member] = value;
    goals.look(status);
    EXPECT_EQ(state_of(goals, 1), State::kExecuting) << member;
    EXPECT_EQ(state_of(goals, 2), State::kExecuting) << member;
  }
  Json other = kWell;  // a rule that is about no component
  other["health"] = 2;
  goals.look(other);
  EXPECT_EQ(state_of(goals, 1), State::kSucceeded);
  EXPECT_EQ(state_of(goals, 2), State::kExecuting);
}

TEST(RecoveryGoals, OfWhatIsMistypedEndWithTheNearestName) {
  RecoveryGoals goals;
  goals.look(with_ill_camera());
  ASSERT_TRUE(goals.begin({id_of(1), "camrea", 0s}, kNow, kWall));
  goals.look_again();
  EXPECT_EQ(state_of(goals, 1), State::kAborted);
  EXPECT_EQ(goals.find(id_of(1))->result["message"],
            "there is no component 'camrea'; did you mean 'camera'?");
}

TEST(RecoveryGoals, EndWhenTheirTimeIsOver) {
  RecoveryGoals goals;
  goals.look(with_ill_camera());
  ASSERT_TRUE(goals.begin({id_of(1), "camera", 5s}, kNow, kWall));
  ASSERT_TRUE(goals.begin({id_of(2), "camera", 0s}, kNow, kWall));
  ASSERT_TRUE(goals.begin({id_of(3), "camera", -1s}, kNow, kWall));
  goals.look_again();
  EXPECT_EQ(state_of(goals, 3), State::kAborted);
  EXPECT_EQ(goals.due(), kNow + 5s);
  goals.expire(kNow + 4s);
  EXPECT_EQ(state_of(goals, 1), State::kExecuting);
  goals.expire(kNow + 5s);
  EXPECT_EQ(state_of(goals, 1), State::kAborted);
  EXPECT_EQ(goals.find(id_of(1))->result["message"],
            "it took too long; camera is down: redeploy camera");
  EXPECT_EQ(goals.due(), kNever);
  EXPECT_EQ(state_of(goals, 2), State::kExecuting);
}

TEST(RecoveryGoals, AreCanceledById) {
  RecoveryGoals goals;
  for (int i = 1; i <= 3; ++i)
    ASSERT_TRUE(goals.begin({id_of(i), "camera", 0s}, kNow, kWall + std::chrono::seconds(i)));
  EXPECT_FALSE(goals.begin({id_of(1), "planner", 0s}, kNow, kWall)) << "the id is taken";
  EXPECT_THAT(goals.cancel(id_of(9), {}), testing::IsEmpty());
  EXPECT_THAT(goals.cancel(id_of(2), {}), testing::ElementsAre(id_of(2)));
  EXPECT_EQ(state_of(goals, 2), State::kCanceled);
  EXPECT_THAT(goals.cancel(id_of(2), {}), testing::IsEmpty()) << "it has ended";
  EXPECT_THAT(goals.cancel({}, kWall + 1s), testing::ElementsAre(id_of(1))) << "those until then";
  EXPECT_THAT(goals.cancel({}, {}), testing::ElementsAre(id_of(3))) << "all";
}

TEST(RecoveryGoals, AreBoundedForAllClients) {
  RecoveryGoals goals;
  goals.look(with_ill_camera());
  const int many = 2 * static_cast<int>(RecoveryGoals::kMostOpen + RecoveryGoals::kMostEnded);
  for (int i = 0; i < many; ++i) {
    ASSERT_TRUE(goals.begin({id_of(i), "camera", 0s}, kNow, kWall));
    goals.look_again();
    EXPECT_LE(goals.all().size(), RecoveryGoals::kMostOpen + RecoveryGoals::kMostEnded + 1);
  }
  EXPECT_EQ(state_of(goals, many - 1), State::kExecuting) << "the newest";
  EXPECT_EQ(goals.find(id_of(0)), nullptr) << "the oldest";
  goals.look(kWell);
  for (const auto* goal : goals.all()) EXPECT_NE(goal->state, State::kExecuting);
}

}  // namespace
}  // namespace culprit::ros_api
