#include "cli/diagnostic_report.h"

#include <set>

#include <gtest/gtest.h>

#include "language/checker.h"
#include "language/explanations.h"

namespace culprit::cli {
namespace {

CheckedFile checked(const std::string& name, const std::string& text) {
  Source source(name, text);
  auto diagnostics = check(source).diagnostics;
  return {std::move(source), std::move(diagnostics)};
}

TEST(DiagnosticReport, JsonHoldsPlaceCauseAndRemedy) {
  const auto report = json_report(
      {checked("a.rules", "ROBOT good\n"), checked("b.rules", "ROBOT good\nrobot bad\n")});
  ASSERT_EQ(report.size(), 1u);
  EXPECT_EQ(
      report[0],
      Json(
          {{"file", "b.rules"},
           {"code", "R001"},
           {"severity", "error"},
           {"line", 2},
           {"column", 1},
           {"end_line", 2},
           {"end_column", 6},
           {"cause", "no statement begins with 'robot'"},
           {"remedy", "did you mean ROBOT?"},
           {"fix",
            {{"line", 2}, {"column", 1}, {"end_line", 2}, {"end_column", 6}, {"text", "ROBOT"}}}}));
}

TEST(DiagnosticReport, OffersAFixOnlyWhereThereIsOne) {
  const CheckedFile file = checked("a.rules", "CYCLE 200\n");
  ASSERT_EQ(json_report({file}).size(), 1u);
  EXPECT_FALSE(json_report({file})[0].contains("fix"));
  EXPECT_FALSE(sarif_report({file})["runs"][0]["results"][0].contains("fixes"));
}

TEST(DiagnosticReport, JsonOfNothingWrongIsAnEmptyArray) {
  EXPECT_EQ(to_text(json_report({checked("a.rules", "ROBOT good\n")})), "[]");
}

TEST(DiagnosticReport, ColumnsCountCharactersNotBytes) {
  const auto report = json_report({checked("a.rules", "CONST a = \"äöü\" x\n")});
  ASSERT_EQ(report.size(), 1u);
  EXPECT_EQ(report[0]["column"], 17);
  EXPECT_EQ(report[0]["end_column"], 18);
}

TEST(DiagnosticReport, SarifPointsAtARuleOfItsDriverAndAtTheText) {
  const auto report = sarif_report({checked("my robot.rules", "ROBOT good\nrobot bad\n")});
  EXPECT_EQ(report["version"], "2.1.0");
  ASSERT_EQ(report["runs"].size(), 1u);
  const auto& run = report["runs"][0];
  EXPECT_EQ(run["tool"]["driver"]["name"], "culprit");
  std::set<std::string> ids;
  for (const auto& rule : run["tool"]["driver"]["rules"]) {
    ids.insert(rule["id"]);
    EXPECT_FALSE(rule["shortDescription"]["text"].get<std::string>().empty());
    EXPECT_FALSE(rule["fullDescription"]["text"].get<std::string>().empty());
  }
  EXPECT_EQ(ids.size(), explanations().size());

  ASSERT_EQ(run["results"].size(), 1u);
  const auto& result = run["results"][0];
  EXPECT_TRUE(ids.contains(result["ruleId"]));
  EXPECT_EQ(result["ruleId"], "R001");
  EXPECT_EQ(result["level"], "error");
  EXPECT_EQ(result["message"]["text"], "no statement begins with 'robot'\ndid you mean ROBOT?");
  const auto& place = result["locations"][0]["physicalLocation"];
  EXPECT_EQ(place["artifactLocation"]["uri"], "my%20robot.rules");
  EXPECT_EQ(place["region"],
            Json({{"startLine", 2}, {"startColumn", 1}, {"endLine", 2}, {"endColumn", 6}}));
  ASSERT_EQ(result["fixes"].size(), 1u);
  EXPECT_EQ(result["fixes"][0]["description"]["text"], "change 'robot' to 'ROBOT'");
  const auto& change = result["fixes"][0]["artifactChanges"][0];
  EXPECT_EQ(change["artifactLocation"], place["artifactLocation"]);
  EXPECT_EQ(change["replacements"][0]["deletedRegion"], place["region"]);
  EXPECT_EQ(change["replacements"][0]["insertedContent"]["text"], "ROBOT");
}

TEST(DiagnosticReport, SarifSaysWhatIsOnlyAWarning) {
  const auto report = sarif_report(
      {checked("a.rules",
               "COMPONENT camera\nRULE R\n POLICIES ERROR\n TRIGGER x > 1\n  STRATEGY s 50 10\n"
               "   ADAPTATION camrea restart 5\n")});
  ASSERT_EQ(report["runs"][0]["results"].size(), 1u);
  EXPECT_EQ(report["runs"][0]["results"][0]["level"], "warning");
}

TEST(DiagnosticReport, SurvivesTextThatIsNotUtf8) {
  const auto file = checked("a\xff.rules", "\xff\xfe ROBOT x\nCONST \xc3 = 3\n");
  EXPECT_FALSE(parse_json(to_text(json_report({file}))).empty());
  EXPECT_EQ(parse_json(to_text(sarif_report({file})))["version"], "2.1.0");
}

}  // namespace
}  // namespace culprit::cli
