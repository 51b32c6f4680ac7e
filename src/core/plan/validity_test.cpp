// Which strategies make sense now (paper, condition 2)?
#include "plan/validity.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "plan/bayes/test_scene.h"

namespace culprit::plan {
namespace {

// The effect of an earlier adaptation is not known yet.
TEST(Validity, AsksOfEachComponentOnlyWhatItsFirstAdaptationNeeds) {
  Scene scene(
      "COMPONENT camera NODE /camera LAUNCH \"camera\"\nCOMPONENT lamp NODE /lamp\n"
      "RULE Dark\nPOLICIES ERROR\nTRIGGER brightness < 0.5\n"
      "STRATEGY again 50 10\nADAPTATION camera start 5\nADAPTATION camera set_parameter gain 1 2\n"
      "STRATEGY tune 50 10\nADAPTATION camera set_parameter gain 1 2\n"
      "STRATEGY both 50 10\nADAPTATION camera start 5\nADAPTATION lamp set_parameter on 1 2\n");
  const auto invalid = [&](const char* strategy) {
    return invalidity(scene.rules()[scene.strategy(strategy)], *scene);
  };
  scene.process("camera", ProcessState::kGone);
  EXPECT_FALSE(invalid("Dark.again")) << invalid("Dark.again")->reason;
  EXPECT_TRUE(invalid("Dark.tune"));
  EXPECT_FALSE(invalid("Dark.both"));
  scene.process("lamp", ProcessState::kGone);
  ASSERT_TRUE(invalid("Dark.both")) << "another component is another question";
  EXPECT_EQ(invalid("Dark.both")->component, scene.component("lamp"));
}

TEST(Validity, RulesOutToEndOrStartWhatIsOnAComputerThatCannotBeAsked) {
  Scene scene(
      "COMPONENT lidar NODE /lidar UNIT lidar.service HOST rover2\n"
      "RULE Dark\nPOLICIES ERROR\nTRIGGER brightness < 0.5\n"
      "STRATEGY again 50 10\nADAPTATION lidar redeploy 5\n"
      "STRATEGY tune 50 10\nADAPTATION lidar set_parameter gain 1 2\n");
  const auto invalid = [&](const char* strategy) {
    return invalidity(scene.rules()[scene.strategy(strategy)], *scene);
  };
  EXPECT_FALSE(invalid("Dark.again"));
  scene->components[scene.component("lidar")].is_out_of_reach = true;
  ASSERT_TRUE(invalid("Dark.again"));
  EXPECT_EQ(invalid("Dark.again")->reason, "is on rover2, which cannot be asked");
  EXPECT_TRUE(invalid("Dark.again")->waits);
  EXPECT_FALSE(invalid("Dark.tune")) << "its node is heard";
}

// A dead or inactive component is deactivated already, and what no step takes is not given back. But one of the steps
// has to change something.
TEST(Validity, PassesOverStepsThatHaveNothingToDo) {
  Scene scene(
      "COMPONENT planner NODE /planner\nCOMPONENT driver NODE /driver LAUNCH \"driver\"\n"
      "COMPONENT lamp NODE /lamp\n"
      "RULE Silent\nPOLICIES ERROR\nTRIGGER x > 1\n"
      "STRATEGY around 50 10\nADAPTATION planner deactivate 2\nTHEN ADAPTATION driver redeploy 5\n"
      "THEN ADAPTATION planner activate 2\n"
      "STRATEGY lit 50 10\nADAPTATION planner deactivate 2\nTHEN ADAPTATION lamp activate 5\n"
      "THEN ADAPTATION planner activate 2\n"
      "STRATEGY tuned 50 10\nADAPTATION planner deactivate 2\n"
      "THEN ADAPTATION planner set_parameter gain 1 2\nTHEN ADAPTATION driver redeploy 5\n");
  const auto reason = [&](const char* strategy) {
    const auto found = invalidity(scene.rules()[scene.strategy(strategy)], *scene);
    return found ? found->reason : "";
  };
  EXPECT_EQ(reason("Silent.around"), "");
  EXPECT_EQ(reason("Silent.lit"), "");
  ComponentState& planner = scene->components[scene.component("planner")];
  planner.lifecycle = Lifecycle::kInactive;
  EXPECT_EQ(reason("Silent.around"), "");
  EXPECT_EQ(reason("Silent.lit"), "planner is not active") << "it would change nothing";
  planner.brought = Brought{Lifecycle::kInactive, false, true};
  EXPECT_EQ(reason("Silent.lit"), "") << "an earlier try has left it inactive";
  scene.process("planner", ProcessState::kGone);
  EXPECT_EQ(reason("Silent.around"), "");
  EXPECT_EQ(reason("Silent.tuned"), "planner is not alive") << "a dead one sets no parameter";
}

// A redeploy restores the lifecycle, so nothing that was deactivated sends anything after it.
TEST(Validity, RulesOutToRedeployForItsDataWhatOthersHaveDeactivated) {
  Scene scene(
      "COMPONENT camera NODE /camera LAUNCH \"camera\"\n"
      "RULE Silent\nPOLICIES ERROR\nTRIGGER age(/rgb) > 1s\n"
      "STRATEGY restart 50 10\nADAPTATION camera restart 2\n"
      "STRATEGY again 50 10\nADAPTATION camera redeploy 5\n"
      "RULE Leaks\nPOLICIES ERROR\nTRIGGER memory(camera) > 500\n"
      "STRATEGY shrink 50 10\nADAPTATION camera redeploy 5\n");
  scene->graph.endpoint_appeared("/camera", EndpointKind::kPublisher, "/rgb");
  const auto invalid = [&](const char* strategy) {
    return invalidity(scene.rules()[scene.strategy(strategy)], *scene);
  };
  EXPECT_FALSE(invalid("Silent.again"));
  ComponentState& camera = scene->components[scene.component("camera")];
  camera.lifecycle = camera.intended_lifecycle = Lifecycle::kInactive;
  ASSERT_TRUE(invalid("Silent.again"));
  EXPECT_TRUE(invalid("Silent.again")->waits);
  EXPECT_FALSE(invalid("Silent.restart")) << "it activates";
  EXPECT_FALSE(invalid("Leaks.shrink")) << "that is no matter of its lifecycle";
  scene.tried("Silent.restart");
  ASSERT_TRUE(invalid("Silent.again"));
  EXPECT_FALSE(invalid("Silent.again")->waits) << "all was tried";
  camera.brought = Brought{Lifecycle::kInactive, false, true};
  EXPECT_FALSE(invalid("Silent.again")) << "a strategy owes it its activation";
}

// It holds what it has set as long as its failure is there, and no more than that.
TEST(Validity, RulesOutToSetWhatALastResortHasSet) {
  Scene scene(
      "COMPONENT drive NODE /drive\nCOMPONENT lamp NODE /lamp\n"
      "RULE Lost\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY look 50 10\nADAPTATION lamp "
      "set_parameter gain 1 2\nSTRATEGY halt 50 10 LASTRESORT\n"
      "ADAPTATION lamp set_parameter on 1 2\nADAPTATION drive set_parameter speed 0 2\n"
      "RULE Slow\nPOLICIES ERROR\nTRIGGER y > 1\n"
      "STRATEGY faster 50 10\nADAPTATION drive set_parameter speed 2 2\n"
      "STRATEGY tune 50 10\nADAPTATION drive set_parameter gain 2 2\n");
  const auto is_invalid = [&](const char* strategy) {
    return invalidity(scene.rules()[scene.strategy(strategy)], *scene).has_value();
  };
  scene.fail("Lost");
  EXPECT_FALSE(is_invalid("Slow.faster"));
  scene->states.state(scene.rule("Lost")).standing = {{scene.strategy("Lost.halt"), scene->now}};
  EXPECT_TRUE(is_invalid("Slow.faster"));
  EXPECT_FALSE(is_invalid("Slow.tune"));
}

// The rule Lost of `level` has this last resort, and Other of level WARNING has `strategies`.
Scene beside_last_resort(const std::string& level, const std::string& last_resort,
                         const std::string& strategies) {
  return Scene(
      "COMPONENT loc NODE /loc LAUNCH \"loc\"\nCOMPONENT tool NODE /tool LAUNCH \"tool\"\n"
      "COMPONENT relay NODE /relay\n"
      "RULE Lost\nPOLICIES " +
      level + "\nTRIGGER x > 1\nSTRATEGY look 50 10\nADAPTATION loc restart 2\n" +
      "STRATEGY safe 50 10 LASTRESORT\n" + last_resort +
      "RULE Other\nPOLICIES WARNING\nTRIGGER y > 1\n" + strategies);
}

void let_stand(Scene& scene) {
  scene.fail("Lost");
  scene->states.state(scene.rule("Lost")).standing = {{scene.strategy("Lost.safe"), scene->now}};
}

std::optional<Invalid> invalid_in(Scene& scene, const char* strategy) {
  return invalidity(scene.rules()[scene.strategy(strategy)], *scene);
}

TEST(Validity, LeavesInactiveWhatALastResortHasDeactivated) {
  Scene scene = beside_last_resort("ERROR", "ADAPTATION tool deactivate 1\n",
                                   "STRATEGY again 50 10\nADAPTATION tool restart 2\n"
                                   "STRATEGY anew 50 10\nADAPTATION tool redeploy 2\n"
                                   "STRATEGY off 50 10\nADAPTATION tool stop 2\n");
  EXPECT_FALSE(invalid_in(scene, "Other.again"));
  let_stand(scene);
  EXPECT_TRUE(invalid_in(scene, "Other.again"));
  ASSERT_TRUE(invalid_in(scene, "Other.anew"));
  EXPECT_EQ(invalid_in(scene, "Other.anew")->reason, "is held by safe, the last resort of Lost");
  EXPECT_TRUE(invalid_in(scene, "Other.anew")->waits) << "it is no attempt in vain";
  EXPECT_FALSE(invalid_in(scene, "Other.off"));
  scene.process("tool", ProcessState::kGone);
  EXPECT_FALSE(invalid_in(scene, "Other.anew")) << "a dead process is started again";
}

// They are nodes of one process.
TEST(Validity, LeavesTheProcessOfWhatALastResortHolds) {
  const std::string strategies =
      "STRATEGY anew 50 10\nADAPTATION loc redeploy 2\nSTRATEGY off 50 10\nADAPTATION loc stop 2\n";
  Scene scene = beside_last_resort("ERROR", "ADAPTATION tool deactivate 1\n", strategies);
  let_stand(scene);
  EXPECT_FALSE(invalid_in(scene, "Other.anew"));
  scene->components[scene.component("loc")].ends_with = {scene.component("tool")};
  ASSERT_TRUE(invalid_in(scene, "Other.anew"));
  EXPECT_EQ(invalid_in(scene, "Other.anew")->component, scene.component("tool"));
  EXPECT_TRUE(invalid_in(scene, "Other.anew")->waits);
  EXPECT_FALSE(invalid_in(scene, "Other.off")) << "it does nothing then";
  Scene stopped = beside_last_resort("ERROR", "ADAPTATION tool stop 1\n", strategies);
  let_stand(stopped);
  stopped.process("tool", ProcessState::kGone);
  stopped->components[stopped.component("loc")].ends_with = {stopped.component("tool")};
  EXPECT_TRUE(invalid_in(stopped, "Other.anew")) << "it would be started again";
}

// Its own rule goes on: the new process is brought to inactive.
TEST(Validity, LetsARuleReplaceWhatItHasDeactivated) {
  Scene scene(
      "COMPONENT tool NODE /tool LAUNCH \"tool\"\nRULE Lost\nPOLICIES ERROR\nTRIGGER x > 1\n"
      "STRATEGY anew 50 10\nADAPTATION tool redeploy 2\n"
      "STRATEGY again 50 10\nADAPTATION tool restart 2\n"
      "STRATEGY safe 50 10 LASTRESORT\nADAPTATION tool deactivate 1\n");
  let_stand(scene);
  EXPECT_FALSE(invalid_in(scene, "Lost.anew"));
  EXPECT_TRUE(invalid_in(scene, "Lost.again"));
}

TEST(Validity, LeavesStoppedWhatALastResortHasStopped) {
  Scene scene = beside_last_resort("ERROR", "ADAPTATION tool stop 1\n",
                                   "STRATEGY anew 50 10\nADAPTATION tool redeploy 2\n"
                                   "STRATEGY back 50 10\nADAPTATION tool start 2\n");
  scene.process("tool", ProcessState::kGone);
  EXPECT_FALSE(invalid_in(scene, "Other.anew")) << "it died by itself";
  let_stand(scene);
  EXPECT_TRUE(invalid_in(scene, "Other.anew"));
  EXPECT_TRUE(invalid_in(scene, "Other.back"));
}

// A part that holds already is done, and one that cannot be done keeps no other from being begun.
TEST(LastResortParts, AreDoneEachForItself) {
  Scene scene = beside_last_resort(
      "ERROR", "ADAPTATION tool deactivate 1\nADAPTATION relay set_parameter cut true 1\n",
      "STRATEGY anew 50 10\nADAPTATION tool redeploy 2\n");
  const auto parts = [&] {
    return parts_of_last_resort(scene.rules()[scene.strategy("Lost.safe")], *scene);
  };
  EXPECT_EQ(parts().obstacles, (std::vector<std::string>{"", ""}));
  scene->components[scene.component("tool")].lifecycle = Lifecycle::kInactive;
  EXPECT_EQ(parts().obstacles, (std::vector<std::string>{"", ""}));
  scene.process("tool", ProcessState::kGone);
  EXPECT_EQ(parts().obstacles, (std::vector<std::string>{"", ""})) << "a dead tool does nothing";
  scene->components[scene.component("tool")].in_graph = true;
  EXPECT_EQ(parts().obstacles, (std::vector<std::string>{"tool is not alive", ""}))
      << "one that hangs may";
  EXPECT_EQ(parts().obstacle, "");
  scene.process("relay", ProcessState::kGone);
  EXPECT_EQ(parts().obstacle, "tool is not alive");
}

TEST(LastResortParts, YieldToWhatIsAsCriticalOrMore) {
  const std::string slower =
      "STRATEGY look 50 10\nADAPTATION relay set_parameter on true 2\n"
      "STRATEGY slower 50 10 LASTRESORT\nADAPTATION tool set_parameter speed 0.4 1\n";
  const auto obstacle = [&](const char* level, const char* value) {
    Scene scene = beside_last_resort(
        level, std::string("ADAPTATION tool set_parameter speed ") + value + " 1\n", slower);
    let_stand(scene);
    return parts_of_last_resort(scene.rules()[scene.strategy("Other.slower")], *scene).obstacle;
  };
  EXPECT_EQ(obstacle("ERROR", "0.0"), "tool is held by safe, the last resort of Lost");
  EXPECT_EQ(obstacle("WARNING", "0.0"), "tool is held by safe, the last resort of Lost");
  EXPECT_EQ(obstacle("ERROR", "0.4"), "") << "it sets the same";
  EXPECT_EQ(obstacle("NON_CRITICAL", "0.0"), "");
}

}  // namespace
}  // namespace culprit::plan
