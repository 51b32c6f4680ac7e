// culprit plan --state as a user runs it: files, output and exit codes.
#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/commands.h"
#include "cli/test_command.h"
#include "json/json.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kSunset = "rules/sunset.rules";
constexpr const char* kSunsetState = "rules/tests/sunset.state";

constexpr const char* kAllTopics =
    "TOPIC /managed_subsystem/rgb_camera    10Hz\n"
    "TOPIC /managed_subsystem/depth_camera  10Hz\n"
    "TOPIC /managed_subsystem/sensors_fused 10Hz\n"
    "TOPIC /managed_subsystem/segmentation  10Hz\n";

struct Plan : testing::Test {
  // Gives the exit code; what was printed is in `out` and `err`.
  int plan(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "plan");
    CommandEnd end = end_of_command(add_plan, std::move(arguments));
    out = std::move(end.out);
    err = std::move(end.err);
    return end.exit_code;
  }
  int plan_for(const std::string& state, const std::string& rules = kSunset,
               const std::string& format = "text") {
    const std::string path = testing::TempDir() + "plan_command_test.state";
    std::ofstream(path, std::ios::binary) << state;
    return plan({rules, "--state", path, "--format", format});
  }
  // The rules of SUNSET with `more`.
  std::string sunset_with(const std::string& more) {
    const std::string path = testing::TempDir() + "plan_command_test.rules";
    std::ofstream(path, std::ios::binary) << std::ifstream(kSunset).rdbuf() << more;
    return path;
  }

  std::string out;
  std::string err;
};

std::string indented(const std::string& text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at) + 1;
    if (end - at > 1) result += "    ";
    result += text.substr(at, end - at);
    at = end;
  }
  return result;
}

TEST_F(Plan, SaysWhatTheManualSays) {
  ASSERT_EQ(plan({kSunset, "--state", kSunsetState}), kOk) << err;
  std::ifstream in("docs/plan.md");
  const std::string manual(std::istreambuf_iterator<char>(in), {});
  EXPECT_THAT(manual, HasSubstr(indented(out)));
}

TEST_F(Plan, GivesTheSameAsData) {
  ASSERT_EQ(plan({kSunset, "--state", kSunsetState, "--planner", "paper", "--format", "json"}), kOk)
      << err;
  const auto json = parse_json(out);
  ASSERT_EQ(json["failures"].size(), 4u);
  const auto& dead = json["failures"][0];
  EXPECT_EQ(dead["rule"], "RGBDead");
  EXPECT_EQ(dead["chosen"], "rgb_restart");
  EXPECT_EQ(dead["blamed"], Json({"camera"}));
  EXPECT_FALSE(dead.contains("failing_s")) << "the state says no moment";
  const auto& redeploy = dead["candidates"][1];
  EXPECT_EQ(redeploy["excluded"]["condition"], "other_chosen");
  EXPECT_EQ(redeploy["flips"][0]["kind"], "impact");
  EXPECT_EQ(redeploy["flips"][0]["impact"], 7);
  const auto& segmentation = json["failures"][2];
  EXPECT_TRUE(segmentation["chosen"].is_null());
  EXPECT_EQ(segmentation["candidates"][0]["excluded"]["failure"], "SensorFusionDead");
  EXPECT_EQ(segmentation["candidates"][0]["flips"][0]["rules"],
            Json({"SensorFusionDead", "RGBDead"}));
}

TEST_F(Plan, IsTheBayesPlannersUnlessSaidOtherwise) {
  ASSERT_EQ(plan({kSunset, "--state", kSunsetState}), kOk) << err;
  const std::string usual = out;
  ASSERT_EQ(plan({kSunset, "--state", kSunsetState, "--planner", "bayes"}), kOk) << err;
  EXPECT_EQ(out, usual);
  ASSERT_EQ(plan({kSunset, "--state", kSunsetState, "--planner", "paper"}), kOk) << err;
  EXPECT_NE(out, usual);
}

TEST_F(Plan, TakesTheSwitchesOfRun) {
  ASSERT_EQ(plan({kSunset, "--state", kSunsetState, "--planner", "paper", "--no-impact",
                  "--no-dependencies"}),
            kOk);
  EXPECT_THAT(out, HasSubstr("would redeploy camera (rgb_redeploy, relative cost 0.10)"));
  EXPECT_THAT(out, HasSubstr("would redeploy segmentation"));
}

TEST_F(Plan, OfARobotThatIsWellNamesWhatIsNearest) {
  ASSERT_EQ(plan_for(std::string(kAllTopics) + "SIGNAL segmentation_entropy            0.05\n"),
            kOk);
  EXPECT_EQ(out,
            "No failure awaits a decision.\n"
            "Nearest to a failure:\n"
            "  SegmentationBad: segmentation_entropy is 0.05, compared with 0.06\n"
            "Unknown, and so no failure yet: autofocus_needed\n");
}

TEST_F(Plan, SaysHowLongAFailureHasBeenThereAtAMoment) {
  ASSERT_EQ(plan_for("TOPIC /managed_subsystem/rgb_camera 10Hz 6s: silent\nRUN 8s\n"), kOk);
  EXPECT_THAT(out, HasSubstr("RGBDead (ERROR, for 1.7 s)"));
}

TEST_F(Plan, ChoosesNothingWhileTheInterlockIsClosed) {
  const std::string rules =
      sunset_with("SIGNAL docked DIAGNOSTIC base KEY docked\nINTERLOCK docked\n");
  const std::string killed =
      std::string(kAllTopics) + "COMPONENT camera PUBLISHES /managed_subsystem/rgb_camera KILLED\n";
  ASSERT_EQ(plan_for(killed + "SIGNAL docked true\n", rules), kOk) << err;
  EXPECT_THAT(out, HasSubstr("would redeploy camera"));
  ASSERT_EQ(plan_for(killed + "SIGNAL docked false\n", rules), kOk) << err;
  EXPECT_THAT(out, HasSubstr("RGBDead.rgb_redeploy is held back: INTERLOCK docked is false"));
  EXPECT_THAT(out, Not(HasSubstr("would redeploy")));
  EXPECT_THAT(out, Not(HasSubstr("  chosen\n")));
  ASSERT_EQ(plan_for(killed, rules, "json"), kOk) << err;
  const auto answer = parse_json(out);
  for (const auto& failure : answer["failures"]) {
    EXPECT_TRUE(failure["chosen"].is_null());
    if (failure["rule"] != "RGBDead") continue;
    EXPECT_EQ(failure["text"], "RGBDead.rgb_redeploy is held back: INTERLOCK docked is unknown");
    for (const auto& candidate : failure["candidates"]) {
      EXPECT_FALSE(candidate["chosen"]);
      if (candidate["strategy"] == "rgb_redeploy") {
        EXPECT_EQ(candidate["excluded"]["condition"], "withheld");
      }
    }
  }
}

// A strategy that run would not choose for lack of evidence is not planned; the one it would choose
// is.
TEST_F(Plan, HearsTheEvidence) {
  const std::string rules = sunset_with(
      "RULE SegmentationSuspected\n  POLICIES ERROR\n"
      "  TRIGGER age(/managed_subsystem/segmentation) > 500ms\n"
      "    STRATEGY guess 99 50\n      ADAPTATION camera redeploy 1\n");
  ASSERT_EQ(plan_for(std::string(kAllTopics) +
                         "COMPONENT camera PUBLISHES /managed_subsystem/rgb_camera\n"
                         "COMPONENT segmentation PUBLISHES /managed_subsystem/segmentation\n"
                         "TOPIC /managed_subsystem/segmentation silent\n",
                     rules),
            kOk)
      << err;
  EXPECT_THAT(out,
              HasSubstr("SegmentationSuspected.guess is held back: camera runs and publishes "
                        "/managed_subsystem/rgb_camera; it does not publish the silent topic"));
  EXPECT_THAT(out, Not(HasSubstr("would redeploy camera")));
}

TEST_F(Plan, NamesEveryMistakeOfAState) {
  EXPECT_EQ(plan_for("COMPONENT camra KILLED\nSTRATEGY rgb_restart FAILED\n"), kFailed);
  EXPECT_EQ(out, "");
  EXPECT_THAT(err, HasSubstr(":1:11: error[R011]"));
  EXPECT_THAT(err, HasSubstr("did you mean camera?"));
  EXPECT_THAT(err, HasSubstr(":2:22: error[R002]"));
  EXPECT_EQ(plan({kSunset, "--state", "no/such.state"}), kFailed);
  EXPECT_THAT(err, HasSubstr("no/such.state"));
  EXPECT_EQ(plan({"no/such.rules", "--state", kSunsetState}), kFailed);
}

}  // namespace
}  // namespace culprit::cli
