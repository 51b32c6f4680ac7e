#include "language/checker.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "language/evaluate.h"
#include "language/explanations.h"
#include "language/test_example_robot.h"
#include "live_checks/live_checks.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

std::string golden_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

// Loads the files that golden files include.
Expected<Source> load_golden(const std::string& file, const std::string&) {
  const auto path = std::filesystem::path("src/core/language/golden") / file;
  if (!std::filesystem::exists(path)) return Error{"there is no '" + file + "'"};
  return Source(file, golden_text(path));
}

std::string all_messages(const Source& source, const Checked& checked) {
  std::string out;
  for (const Diagnostic& d : checked.diagnostics) out += render(d, source);
  return out;
}

RuleSet rules_of(const std::string& text) {
  const Source source("test.rules", text);
  Checked checked = check(source);
  EXPECT_TRUE(checked.rules) << all_messages(source, checked);
  return checked.rules ? std::move(*checked.rules) : RuleSet{};
}

std::vector<std::string> codes_of(const std::string& text,
                                  Strictness strictness = Strictness::kLenient) {
  std::vector<std::string> codes;
  for (const Diagnostic& d : check(Source("test.rules", text), strictness).diagnostics)
    codes.push_back(to_string(d.code));
  return codes;
}

// The paper's figure "A specific rule in the syntax of our DSL", line numbers stripped.
constexpr const char* kPaperRule = R"(RULE SegmentationBad
  POLICIES WARNING 
  TRIGGER segmentation_entropy > 0.06
    STRATEGY recalibration 80 50
      ADAPTATION fusion set_parameter recalibration true 2
    STRATEGY enhancement_activate 10 50
      ADAPTATION image_enhancement activate 5
      ADAPTATION fusion change_communication camera_input rgb_enhanced 2
    STRATEGY enhancement_deactivate 10 10
      ADAPTATION image_enhancement deactivate 5
      ADAPTATION fusion change_communication camera_input rgb_raw 2
)";

TEST(Checker, ReadsThePapersRuleAsPrinted) {
  const RuleSet rules = rules_of(kPaperRule);
  ASSERT_EQ(rules.rules.size(), 1u);
  ASSERT_EQ(rules.strategies.size(), 3u);
  EXPECT_EQ(rules.rules[0].policies.criticality, Criticality::kWarning);
  const Strategy& activate = rules.strategies[1];
  EXPECT_EQ(activate.name, "enhancement_activate");
  EXPECT_DOUBLE_EQ(activate.success.value, 0.1);
  EXPECT_DOUBLE_EQ(activate.confidence, 50);
  EXPECT_EQ(activate.impact, Cycles{5});  // the maximum, not the sum
  EXPECT_EQ(activate.adaptations[1].type, AdaptationType::kChangeCommunication);
  EXPECT_EQ(activate.adaptations[1].subject, "camera_input");
  EXPECT_EQ(activate.adaptations[1].topic, "rgb_enhanced");
  EXPECT_EQ(rules.heaviest, Cycles{5});
}

TEST(Checker, TakesCyclesFromAMillisecondToAnHour) {
  const std::vector<std::string> refused = {"R033"};
  EXPECT_EQ(codes_of("CYCLE 999us\n"), refused);
  EXPECT_EQ(codes_of("CYCLE 1ms\n"), codes_of("CYCLE 200ms\n"));
  EXPECT_EQ(codes_of("CYCLE 61min\n"), refused);
}

// The paper's figure "A generic rule in the syntax of our DSL": understood line by line, and each
// line is said to be a form that is to be filled in.
TEST(Checker, TakesThePapersGenericRuleForATemplate) {
  EXPECT_EQ(codes_of(R"(RULE <name>
  POLICIES <crit_level>
  TRIGGER <expression>
    STRATEGY <name> <success probability> <initial belief>
      ADAPTATION <component> <type> <parameters> <system impact>
)"),
            (std::vector<std::string>(5, "R008")));
}

// The design's example of the whole language.
constexpr const char* kDesignExample = R"(
ROBOT sunset
CYCLE 200ms

CONST entropy_limit = 0.06

COMPONENT camera  NODE /managed_subsystem/camera         LAUNCH "sunset-node camera"
COMPONENT fusion  NODE /managed_subsystem/sensor_fusion  LAUNCH "sunset-node fusion"
DEPENDENCY fusion ON camera                  # only for edges that the live graph cannot show
IGNORE TOPIC /rosout /clock /parameter_events

SIGNAL segmentation_entropy  DIAGNOSTIC segmentation KEY entropy  STALE 2s  RANGE 0..1
SIGNAL autofocus_needed      DIAGNOSTIC camera KEY autofocus_needed
SIGNAL visibility            TOPIC /water_visibility FIELD data
SIGNAL exposure              PARAMETER camera exposure

RULE SegmentationBad
  POLICIES WARNING FOR 500ms HOLD 3/5 COOLDOWN 10s ATTEMPTS 6
  TRIGGER segmentation_entropy > entropy_limit && rate(/managed_subsystem/segmentation) > 1
    STRATEGY recalibration 80 50
      ADAPTATION fusion set_parameter recalibration true 2
    STRATEGY enhancement_activate 10 50 WHEN lifecycle(image_enhancement) != "active"
      ADAPTATION image_enhancement activate 5
      ADAPTATION fusion change_communication camera_input rgb_enhanced 2
)";

TEST(Checker, ReadsTheWholeLanguage) {
  const RuleSet rules = rules_of(kDesignExample);
  EXPECT_EQ(rules.robot, "sunset");
  EXPECT_EQ(rules.cycle, 200ms);
  EXPECT_EQ(rules.components[0].launch, (std::vector<std::string>{"sunset-node", "camera"}));
  EXPECT_EQ(rules.ignored_topics.size(), 3u);
  EXPECT_EQ(rules.signals[0].stale, 2s);
  EXPECT_DOUBLE_EQ(rules.signals[0].range->high, 1);
  const Policies& policies = rules.rules[0].policies;
  EXPECT_EQ(policies.hold_for, 500ms);
  EXPECT_EQ(policies.hold_needed, 3);
  EXPECT_EQ(policies.hold_window, 5);
  EXPECT_EQ(policies.cooldown, 10s);
  EXPECT_EQ(policies.attempts, 6);
  EXPECT_FALSE(rules.strategies[1].when.empty());
  ASSERT_EQ(rules.dependencies.size(), 1u);
  EXPECT_EQ(rules[rules.dependencies[0].consumer].name, "fusion");
}

TEST(Checker, KnowsEveryAdaptation) {
  const RuleSet rules = rules_of(R"(
COMPONENT a LAUNCH "a"
RULE R
 POLICIES ERROR
 TRIGGER !alive(a)
  STRATEGY s1 50 10
   ADAPTATION b set_parameter gain -0.5 * 2 1
   ADAPTATION c increase_parameter FollowPath.max_vel_x 1 2
   ADAPTATION d decrease_parameter n 2 3
   ADAPTATION e change_communication input rgb_raw 4
   ADAPTATION f activate 5
   ADAPTATION g deactivate 6
   ADAPTATION h restart 7
   ADAPTATION a redeploy 8
   ADAPTATION /ns/i change_mode fd_spiral_low 9
   ADAPTATION j call ~/recalibrate 10
  STRATEGY s2 50 10
   ADAPTATION a start 11
  STRATEGY s3 50 10
   ADAPTATION a stop 12
)");
  ASSERT_EQ(rules.strategies.size(), 3u);
  EXPECT_EQ(rules.strategies[0].impact, Cycles{10});
  EXPECT_EQ(rules.strategies[0].adaptations[1].subject, "FollowPath.max_vel_x");
  EXPECT_EQ(rules[rules.strategies[0].adaptations[8].component].node, "/ns/i");
  EXPECT_EQ(rules.heaviest, Cycles{12});
}

// A percentage has no impact behind its value, and is reported.
TEST(Checker, TakesANumberWithASignForARemainderIfAnImpactFollows) {
  const RuleSet rules = rules_of(
      "RULE R\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 50 10\n"
      "ADAPTATION c set_parameter gain 10% 3 2\n");
  EXPECT_EQ(rules.strategies[0].impact, Cycles{2});
}

TEST(Checker, AcceptsTheAliasesOfCriticality) {
  for (const auto& [word, level] : {std::pair{"OK", Criticality::kNonCritical},
                                    {"DEGRADED", Criticality::kWarning},
                                    {"FAILURE", Criticality::kError}}) {
    const RuleSet rules = rules_of(std::string("RULE R\nPOLICIES ") + word +
                                   "\nTRIGGER x > 1\nSTRATEGY s 1 1\nADAPTATION c restart 1\n");
    EXPECT_EQ(rules.rules[0].policies.criticality, level) << word;
  }
}

TEST(Checker, LearnsTypesFromUse) {
  const RuleSet rules = rules_of(R"(
RULE R
 POLICIES ERROR
 TRIGGER docked || mode == "idle" || later == other || other < 3 || parameter(c, gain) > 2
  STRATEGY s 50 10
   ADAPTATION c restart 1
)");
  const auto type = [&](const std::string& name) {
    for (const Signal& s : rules.signals) {
      if (s.name == name) return s.type;
    }
    ADD_FAILURE() << name;
    return Type::kDuration;
  };
  EXPECT_EQ(type("docked"), Type::kBool);
  EXPECT_EQ(type("mode"), Type::kString);
  EXPECT_EQ(type("other"), Type::kDouble);
  EXPECT_EQ(type("later"), Type::kDouble);  // learned from a comparison that comes after
}

// However far away the rule is that gives the type.
TEST(Checker, LearnsTypesAlongChainsOfComparisons) {
  constexpr int kRules = 1000;
  std::string text;
  for (int i = kRules; i >= 0; --i) {
    const std::string n = std::to_string(i);
    const std::string other = i == 0 ? "(late ? s0 : \"dock\")" : "s" + std::to_string(i - 1);
    text += "RULE R" + n + "\n POLICIES ERROR\n TRIGGER s" + n + " == " + other +
            "\n  STRATEGY s 50 10\n   ADAPTATION c restart 1\n";
  }
  for (const Signal& s : rules_of(text).signals)
    EXPECT_EQ(s.type, s.name == "late" ? Type::kBool : Type::kString) << s.name;
}

TEST(Checker, FindsTheThresholdsOfInputs) {
  const RuleSet rules = rules_of(R"(
CONST slow = 5
RULE A
 POLICIES ERROR
 TRIGGER rate(/t) < slow || age(/t) > 500ms
  STRATEGY s 50 10
   ADAPTATION c restart 1
RULE B
 POLICIES ERROR
 TRIGGER 1 >= rate(/t) && phi(/t) * 2 > 1
  STRATEGY s 50 10
   ADAPTATION c restart 1
)");
  for (const Input& input : rules.inputs) {
    switch (input.kind) {
      case Input::Kind::kRate:
        EXPECT_EQ(input.thresholds, (std::vector{1.0, 5.0}));
        EXPECT_TRUE(input.only_compared);
        EXPECT_EQ(input.readers.size(), 2u);
        break;
      case Input::Kind::kAge:
        EXPECT_EQ(input.thresholds, std::vector{0.5});
        break;
      case Input::Kind::kPhi:
        EXPECT_FALSE(input.only_compared);
        break;
      default:
        ADD_FAILURE();
    }
  }
}

TEST(Checker, LooksUpUndeclaredNamesUnlessStrict) {
  EXPECT_TRUE(codes_of(kPaperRule).empty());
  EXPECT_EQ(codes_of(kPaperRule, Strictness::kStrict),
            (std::vector<std::string>{"R012", "R012", "R012"}));
}

// Whether such an impact may be meant depends on how long its cycles take.
TEST(Checker, TakesALargeImpactOfShortCyclesAsItIs) {
  const std::string rule =
      "COMPONENT c\nRULE r\n  POLICIES ERROR\n  TRIGGER x > 1\n    STRATEGY s 50 10\n"
      "      ADAPTATION c restart 5000\n";
  EXPECT_EQ(codes_of(rule), std::vector<std::string>{"R032"});
  EXPECT_EQ(codes_of("CYCLE 10ms\n" + rule), std::vector<std::string>());
}

TEST(Checker, SplitsLaunchCommandsWithoutAShell) {
  const RuleSet rules =
      rules_of("COMPONENT c LAUNCH \"prog --name 'two words' a\\\\ b $HOME ; rm\"\n");
  EXPECT_EQ(rules.components[0].launch,
            (std::vector<std::string>{"prog", "--name", "two words", "a b", "$HOME", ";", "rm"}));
}

// Each file in golden/ holds mistakes, and beside it are the diagnostics. strict_* are checked
// strictly, live_* against example_robot(); newcomer_* hold the mistakes of people who come from
// elsewhere. CULPRIT_WRITE_GOLDEN=1 writes the present diagnostics, for a person to read and
// commit.
TEST(Checker, SaysWhatTheGoldenFilesSay) {
  const std::filesystem::path folder = "src/core/language/golden";
  std::set<Code> unseen;
  for (const Explanation& e : explanations()) unseen.insert(e.code);
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".rules") continue;
    if (entry.path().filename().string().starts_with("format_")) continue;  // of formatter_test.cpp
    const std::string name = entry.path().filename().string();
    const Expansion rules = expand(Source(name, golden_text(entry.path())), load_golden);
    const bool is_strict = name.starts_with("strict_");
    const Strictness strictness = is_strict ? Strictness::kStrict : Strictness::kLenient;
    const bool has_robot = name.starts_with("live_");
    const std::string said =
        all_messages(rules.source, has_robot ? live_checks::check_against(example_robot(), rules)
                                             : check(rules, strictness));
    for (const Explanation& e : explanations()) {
      if (said.find("[" + to_string(e.code) + "]") != std::string::npos) unseen.erase(e.code);
    }
    const auto expected = std::filesystem::path(entry.path()).replace_extension(".expected");
    if (std::getenv("CULPRIT_WRITE_GOLDEN") != nullptr)
      std::ofstream(expected, std::ios::binary) << said;
    EXPECT_EQ(said, golden_text(expected)) << entry.path();
  }
  for (const Code code : unseen) ADD_FAILURE() << to_string(code) << " is in no golden file";
}

TEST(Checker, KeepsConstantsThatAreText) {
  const RuleSet rules = rules_of(
      "CONST long_enough_to_be_allocated = \"rgb_camera_image_of_the_left_side\"\n"
      "COMPONENT c\n"
      "RULE r\n  POLICIES ERROR\n  TRIGGER age(/t) > 1s\n"
      "    STRATEGY s 50 10\n"
      "      ADAPTATION c set_parameter p long_enough_to_be_allocated 2\n");
  const Program& value = rules.strategies.at(0).adaptations.at(0).value;
  EXPECT_EQ(evaluate(value, {}).s, "rgb_camera_image_of_the_left_side");
}

TEST(Checker, DoesNotBlameASignalForABrokenConstant) {
  EXPECT_EQ(codes_of("CONTS limit = 0.06\nRULE r\n  POLICIES ERROR\n  TRIGGER entropy > limit\n"
                     "    STRATEGY s 50 10\n      ADAPTATION c restart 5\n"),
            std::vector<std::string>{"R001"});
}

TEST(Checker, RefusesRunTimeValuesWhereConstantsBelong) {
  EXPECT_EQ(codes_of("CONST a = age(/t)\n"), std::vector<std::string>{"R023"});
  EXPECT_EQ(codes_of("COMPONENT c\nRULE r\n  POLICIES ERROR\n  TRIGGER rate(/t, age(/t)) < 1\n"
                     "    STRATEGY s 50 10\n      ADAPTATION c restart 5\n"),
            std::vector<std::string>{"R020"});
}

TEST(Checker, TakesAWholeNameForAServiceEvenIfItLooksLikeAType) {
  for (const std::string service : {"/lidar/srv/enable", "~/srv/enable"}) {
    const RuleSet rules = rules_of(
        "COMPONENT lidar NODE /lidar\nRULE Dead\n  POLICIES ERROR\n  TRIGGER !alive(lidar)\n"
        "    STRATEGY again 50 10\n      ADAPTATION lidar call " +
        service + " 5\n");
    EXPECT_EQ(rules.rules.size(), 1u) << service;
  }
}

TEST(Checker, SuggestsNoTextWithinATextAndNoCallAroundOne) {
  const Source source("test.rules",
                      "SIGNAL heat DIAGNOSTIC \"left motor\" front KEY heat\n"
                      "RULE R\n  POLICIES ERROR REPORT\n  TRIGGER state == \"a\"|\"b\"|\"c\"\n");
  const std::string messages = all_messages(source, check(source));
  EXPECT_EQ(messages.find("write \"\""), std::string::npos) << messages;
  EXPECT_EQ(messages.find("abs("), std::string::npos) << messages;
}

TEST(Checker, SeesCirclesWhateverTheComponentsAreCalled) {
  EXPECT_EQ(codes_of("COMPONENT a NODE /a\nCOMPONENT b NODE /b\n"
                     "DEPENDENCY /a ON b\nDEPENDENCY /b ON a\n"),
            std::vector<std::string>{"R053"});
}

TEST(Checker, SurvivesHostileNesting) {
  for (const char* open : {"(", "!", "-", "1 ? ", "abs(", "1 + (", "x && !("}) {
    std::string expression;
    for (int i = 0; i < 100000; ++i) expression += open;
    EXPECT_FALSE(codes_of("RULE R\nPOLICIES ERROR\nTRIGGER " + expression + "\n").empty());
  }
  std::string chain = "x";
  for (int i = 0; i < 100000; ++i) chain += " + x";
  EXPECT_FALSE(codes_of("RULE R\nPOLICIES ERROR\nTRIGGER " + chain + " > 1\n").empty());
  std::string choices = "x";  // of a type that nothing tells
  for (int i = 0; i < 40; ++i) choices = "a ? (" + choices + ") : y";
  EXPECT_FALSE(codes_of("RULE R\nPOLICIES ERROR\nTRIGGER (" + choices + ") == z\n").empty());
}

TEST(Checker, ShowsNoTextThatSteersATerminal) {
  // C1 and directions are no control characters of ASCII.
  const Source source("evil\x1b]0;x.rules",
                      "TEXT \"\xc2\x9b"
                      "2J\" \xe2\x80\xae \x1b[2J \xc3\xa4\n");
  const std::string messages = all_messages(source, check(source));
  EXPECT_FALSE(messages.empty());
  for (const char* each : {"\x1b", "\xc2\x9b", "\xe2\x80\xae"})
    EXPECT_EQ(messages.find(each), std::string::npos) << messages;
  EXPECT_NE(messages.find("\"?2J\" ? ?[2J \xc3\xa4"), std::string::npos) << messages;
  const Edit edit{{0, static_cast<std::uint32_t>(source.text().size())}, "\x1b"};
  EXPECT_EQ(title_of(edit, source).find('\x1b'), std::string::npos);
}

// ---- files of thousands of components: comparisons that take the square of their number have an end

std::size_t count_of(Code code, const std::vector<Diagnostic>& all) {
  return static_cast<std::size_t>(std::ranges::count(all, code, &Diagnostic::code));
}

TEST(LargeFile, GetsSuggestionsForItsFirstUnknownContainersOnly) {
  constexpr std::size_t kEach = 1000;
  std::string text;
  for (std::size_t i = 0; i < kEach; ++i) {
    const std::string n = std::to_string(i);
    text += "COMPONENT box" + n + " NODE /node_" + n + "\nCOMPONENT c" + n + " NODE /c" + n +
            " IN /nodd_" + n + " PLUGIN a::B\n";
  }
  const Checked checked = check(Source("test.rules", text));
  EXPECT_EQ(count_of(Code::kNoContainer, checked.diagnostics), kEach);
  EXPECT_EQ(std::ranges::count_if(checked.diagnostics,
                                  [](const Diagnostic& d) {
                                    return d.code == Code::kNoContainer && d.fix.has_value();
                                  }),
            Symbols::kMaxComparisons / kEach);
}

TEST(LargeFile, IsSearchedForEffectsWithinABudget) {
  constexpr std::size_t kEach = 3000;
  const std::string last = "c" + std::to_string(kEach - 1);
  std::string text;
  std::string rules;
  for (std::size_t i = 0; i < kEach; ++i) {
    const std::string name = "c" + std::to_string(i);
    text += "COMPONENT " + name + " NODE /" + name + "\n";
    if (i > 0) text += "DEPENDENCY " + name + " ON c" + std::to_string(i - 1) + "\n";
    rules += "RULE R" + name + "\n  POLICIES ERROR\n  TRIGGER !alive(" + name +
             ")\n    STRATEGY s 80 10\n      ADAPTATION " + last + " restart 5\n";
  }
  const Checked checked = check(Source("test.rules", text + rules));
  ASSERT_TRUE(checked.rules);
  const std::size_t found = count_of(Code::kAdaptsEffect, checked.diagnostics);
  EXPECT_GT(found, 0u);
  EXPECT_LT(found, kEach / 2) << "each search passes up to 3000 dependencies";
}

TEST(Effects, ATopicBelongsToTheLongestNodeNameAboveIt) {
  const auto codes = [](const std::string& topic) {
    return codes_of(R"(COMPONENT arm NODE /arm
COMPONENT hand NODE /arm/hand
COMPONENT user NODE /user
DEPENDENCY user ON hand
RULE Silent
  POLICIES ERROR
  TRIGGER age()" + topic +
                    R"() > 1s && alive(arm)
    STRATEGY again 80 10
      ADAPTATION user restart 5
)");
  };
  EXPECT_EQ(codes("/arm/hand/a/b"), std::vector<std::string>{"R048"});
  EXPECT_EQ(codes("/arm/handle"), (std::vector<std::string>{}));
  EXPECT_EQ(codes("/other/hand"), (std::vector<std::string>{}));
}

}  // namespace
}  // namespace culprit
