#include "language/explanations.h"

#include <set>

#include <gtest/gtest.h>

#include "language/test_example_robot.h"
#include "live_checks/live_checks.h"

namespace culprit {
namespace {

// The compiler asks for a line here when a code is added.
bool exists(Code code) {
  switch (code) {
    case Code::kUnknownStatement:
    case Code::kSyntax:
    case Code::kBadToken:
    case Code::kExtraText:
    case Code::kOutOfPlace:
    case Code::kIncomplete:
    case Code::kTooDeep:
    case Code::kPlaceholder:
    case Code::kSettingInRule:
    case Code::kDuplicateName:
    case Code::kUnknownName:
    case Code::kUndeclared:
    case Code::kUnknownFunction:
    case Code::kUnknownAdaptation:
    case Code::kUnknownPolicy:
    case Code::kReservedWord:
    case Code::kBadRosName:
    case Code::kUnused:
    case Code::kTypeMismatch:
    case Code::kUnknownType:
    case Code::kArguments:
    case Code::kNotConstant:
    case Code::kNoValue:
    case Code::kProbabilityRange:
    case Code::kConfidenceRange:
    case Code::kImpactRange:
    case Code::kPolicyRange:
    case Code::kEmptyRange:
    case Code::kShortImpact:
    case Code::kShortWindow:
    case Code::kLongWindow:
    case Code::kLateLastResort:
    case Code::kContradiction:
    case Code::kNoLaunch:
    case Code::kNeverValid:
    case Code::kStopsRequired:
    case Code::kTwoOwners:
    case Code::kTrueWhenWell:
    case Code::kNoShell:
    case Code::kBadGroup:
    case Code::kAdaptsEffect:
    case Code::kMovesInterlock:
    case Code::kAlwaysTrue:
    case Code::kNeverTrue:
    case Code::kCircularDependency:
    case Code::kOscillation:
    case Code::kAlwaysTrueInRange:
    case Code::kNeverTrueInRange:
    case Code::kCovered:
    case Code::kWhenNeverTrue:
    case Code::kWhenContradictsTrigger:
    case Code::kNoLastResort:
    case Code::kNoSuchNode:
    case Code::kNoSuchTopic:
    case Code::kNoSuchParameter:
    case Code::kNoSuchDiagnostic:
    case Code::kNoSuchService:
    case Code::kNoSuchUnit:
    case Code::kCannotLaunch:
    case Code::kNoSuchField:
    case Code::kSeveralNodes:
    case Code::kNoSuchHost:
    case Code::kBadRequest:
    case Code::kRunsOtherwise:
    case Code::kBadCommand:
    case Code::kNoContainer:
    case Code::kCannotInclude:
    case Code::kUnknownTemplate:
    case Code::kTemplateArguments:
    case Code::kUnknownParameter:
    case Code::kEndlessTemplate:
      return true;
  }
  return false;
}

std::vector<std::string> codes_of(const Explanation& e, const std::string& text) {
  std::vector<std::string> codes;
  const auto load = [](const std::string& file, const std::string&) -> Expected<Source> {
    if (file == "packs/nav2.rules") return Source(file, "");
    return Error{"there is no '" + file + "'"};
  };
  const Expansion rules = expand(Source("example.rules", text), load);
  const auto strictness =
      e.title.ends_with("(--strict)") ? Strictness::kStrict : Strictness::kLenient;
  const bool needs_robot = e.why.find("The robot of the example:") != std::string::npos;
  const Checked checked = needs_robot
                              ? live_checks::check_against(example_robot(), rules, strictness)
                              : check(rules, strictness);
  for (const Diagnostic& d : checked.diagnostics) codes.push_back(to_string(d.code));
  return codes;
}

TEST(Explanations, ThereIsOneForEachCodeInOrder) {
  std::set<Code> explained;
  for (const Explanation& e : explanations()) {
    EXPECT_TRUE(explained.empty() || *explained.rbegin() < e.code) << to_string(e.code);
    explained.insert(e.code);
    EXPECT_FALSE(e.title.empty() || e.why.empty()) << to_string(e.code);
    EXPECT_FALSE(e.wrong.empty() || e.right.empty()) << to_string(e.code);
  }
  for (std::uint16_t number = 0; number < 1000; ++number) {
    const Code code{number};
    EXPECT_EQ(exists(code), explained.contains(code)) << to_string(code);
  }
}

TEST(Explanations, EveryWrongExampleShowsItsCodeAndNothingElse) {
  for (const Explanation& e : explanations())
    EXPECT_EQ(codes_of(e, e.wrong), std::vector{to_string(e.code)}) << e.wrong;
}

TEST(Explanations, EveryRightExampleIsRight) {
  for (const Explanation& e : explanations())
    EXPECT_EQ(codes_of(e, e.right), std::vector<std::string>()) << e.right;
}

TEST(Explanations, AreFoundByTheirCode) {
  ASSERT_NE(find_explanation("R012"), nullptr);
  EXPECT_EQ(find_explanation("R012")->code, Code::kUndeclared);
  EXPECT_EQ(find_explanation("r012"), find_explanation("R012"));
  EXPECT_EQ(find_explanation("12"), find_explanation("R012"));
  for (const char* none : {"", "R", "R019", "R012x", "R-12", "R65548", "twelve"})
    EXPECT_EQ(find_explanation(none), nullptr) << none;
}

TEST(Explanations, TheTableOfTheirPageNamesThem) {
  std::string table = "| code | meaning |\n| --- | --- |\n";
  for (const Explanation& e : explanations()) {
    const std::string code = to_string(e.code);
    table += "| [" + code + "](#r" + code.substr(1) + ") | " + e.title + " |\n";
  }
  EXPECT_NE(diagnostics_page().find(table), std::string_view::npos) << table;
}

}  // namespace
}  // namespace culprit
