#include "language/reuse/expansion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/checker.h"
#include "language/parser.h"
#include "language/test_rules.h"
#include "language/test_tree.h"

namespace culprit {
namespace {

using testing::HasSubstr;

using Files = std::map<std::string, std::string>;

Expansion expanded(const std::string& text, const Files& files = {}) {
  return expand(Source("robot.rules", text),
                [&](const std::string& file, const std::string&) -> Expected<Source> {
                  const auto found = files.find(file);
                  if (found == files.end()) return Error{"there is no '" + file + "'"};
                  return Source(found->first, found->second);
                });
}

std::string messages(const Expansion& rules, const std::vector<Diagnostic>& diagnostics) {
  std::string out;
  for (const Diagnostic& d : diagnostics) out += render(d, rules.source);
  return out;
}

// The rules in plain words, without comments and empty lines.
std::string plain(const std::string& text, const Files& files = {}) {
  const Expansion rules = expanded(text, files);
  EXPECT_EQ(messages(rules, rules.mistakes), "");
  std::string out;
  for (std::uint32_t n = 1; n <= rules.source.line_count(); ++n) {
    const std::string_view line = trimmed(rules.source.text(rules.source.line(n)));
    if (!line.empty() && !line.starts_with('#')) out += std::string(line) + "\n";
  }
  return out;
}

const std::string kDriver =
    "TEMPLATE driver(name, topic, hz = 10)\n"
    "  CONST slow = {hz} * 0.5\n"
    "  RULE {name}_slow\n"
    "    POLICIES WARNING\n"
    "    TRIGGER rate({topic}) < slow\n"
    "      STRATEGY restart_{name} 50 10\n"
    "        ADAPTATION {name} restart 5\n"
    "END\n";

std::string driver(const std::string& name, const std::string& topic, const std::string& hz,
                   const std::string& slow = "slow") {
  return "CONST " + slow + " = " + hz + " * 0.5\nRULE " + name + "_slow\nPOLICIES WARNING\n" +
         "TRIGGER rate(" + topic + ") < " + slow + "\nSTRATEGY restart_" + name +
         " 50 10\nADAPTATION " + name + " restart 5\n";
}

TEST(Expansion, LeavesATextWithoutReuseAsItIs) {
  const std::string text = "ROBOT a\nCONST USE_IT = 1\n  # USE driver\nCONST x = 1 # INCLUDE\n";
  const Expansion rules = expanded(text);
  EXPECT_EQ(rules.source.text(), text);
  EXPECT_EQ(rules.source.file_count(), 1u);
}

TEST(Expansion, PutsArgumentsIn) {
  EXPECT_EQ(plain(kDriver + "USE driver(lidar, /scan, 20)\n"), driver("lidar", "/scan", "20"));
  EXPECT_EQ(plain("USE driver(lidar, /scan)\n" + kDriver), driver("lidar", "/scan", "10"));
}

TEST(Expansion, PutsTextsInWithAndWithoutTheirQuotes) {
  EXPECT_EQ(plain("TEMPLATE t(command, state)\nCOMPONENT c LAUNCH \"nice {command} 'x y'\"\n"
                  "INTERLOCK lifecycle(c) == {state}\nEND\n"
                  "USE t(\"ros2 run \\\"a b\\\" c\", \"active\")\n"),
            "COMPONENT c LAUNCH \"nice ros2 run \\\"a b\\\" c 'x y'\"\n"
            "INTERLOCK lifecycle(c) == \"active\"\n");
}

TEST(Expansion, LeavesOtherBracesOfTextsAlone) {
  EXPECT_EQ(plain("TEMPLATE t(arm)\nRULE r\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 1 1\n"
                  "ADAPTATION c call /x \"{name: {arm}, other: {}}\" 5\nEND\nUSE t(left)\n"),
            "RULE r\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 1 1\n"
            "ADAPTATION c call /x \"{name: left, other: {}}\" 5\n");
}

TEST(Expansion, GivesEachUseConstantsOfItsOwn) {
  EXPECT_EQ(
      plain("CONST slow = 1\n" + kDriver + "USE driver(a, /a, 1)\nUSE driver(b, /b, 2)\n"),
      "CONST slow = 1\n" + driver("a", "/a", "1", "slow_2") + driver("b", "/b", "2", "slow_3"));
}

TEST(Expansion, ReadsAFileOnce) {
  const Files files = {{"a.rules", "INCLUDE \"c.rules\"\nCONST a = c\n"},
                       {"b.rules", "INCLUDE \"c.rules\"\nCONST b = c"},
                       {"c.rules", "CONST c = 1\n"}};
  EXPECT_EQ(plain("INCLUDE \"a.rules\"\nINCLUDE \"b.rules\"\nCONST d = b\n", files),
            "CONST c = 1\nCONST a = c\nCONST b = c\nCONST d = b\n");
}

TEST(Expansion, TakesTemplatesOfFiles) {
  EXPECT_EQ(
      plain("INCLUDE \"driver.rules\"\nUSE driver(lidar, /scan)\n", {{"driver.rules", kDriver}}),
      driver("lidar", "/scan", "10"));
}

TEST(Expansion, TemplatesMayUseOthers) {
  EXPECT_EQ(plain("TEMPLATE two(side, hz)\n  USE driver({side}_lidar, /{side}/scan, {hz})\n"
                  "  USE driver({side}_camera, /{side}/image)\nEND\n" +
                  kDriver + "USE two(left, 5)\n"),
            driver("left_lidar", "/left/scan", "5") +
                driver("left_camera", "/left/image", "10", "slow_2"));
}

TEST(Expansion, PutsNamesBelowANamespace) {
  const std::string nav =
      "TEMPLATE nav\n"
      "  COMPONENT amcl NODE /amcl\n  COMPONENT here\n"
      "  COMPONENT part NODE \"/part\" IN /box PLUGIN a::B REMAP \"x:=/y\"\n"
      "  DEPENDENCY amcl ON lidar unknown\n"
      "  IGNORE TOPIC /clock /tf\n"
      "  SIGNAL x TOPIC /amcl_pose FIELD pose.pose.position.x\n"
      "  SIGNAL lost DIAGNOSTIC /amcl KEY lost\n"
      "  RULE Lost\n    POLICIES ERROR\n    TRIGGER x > 1 && lost && !alive(amcl) && level(/amcl) "
      "> 1 && e > 2\n"
      "      STRATEGY again 50 10\n        ADAPTATION amcl call /reinitialize 5\n"
      "        ADAPTATION here call ~/go 5\n"
      "        ADAPTATION amcl change_communication scan /scan 5\n"
      "END\n";
  EXPECT_EQ(plain("COMPONENT lidar NODE /lidar\n" + nav + "USE nav IN /fleet/r1\n"),
            "COMPONENT lidar NODE /lidar\n"
            "COMPONENT fleet_r1_amcl NODE /fleet/r1/amcl\n"
            "COMPONENT fleet_r1_here NODE /fleet/r1/here\n"
            "COMPONENT fleet_r1_part NODE \"/fleet/r1/part\" IN /fleet/r1/box PLUGIN a::B REMAP "
            "\"x:=/y\"\n"
            "DEPENDENCY fleet_r1_amcl ON lidar /fleet/r1/unknown\n"
            "IGNORE TOPIC /clock /fleet/r1/tf\n"
            "SIGNAL fleet_r1_x TOPIC /fleet/r1/amcl_pose FIELD pose.pose.position.x\n"
            "SIGNAL fleet_r1_lost DIAGNOSTIC /amcl KEY lost\n"
            "RULE fleet_r1_Lost\nPOLICIES ERROR\n"
            "TRIGGER fleet_r1_x > 1 && fleet_r1_lost && !alive(fleet_r1_amcl) && level(/amcl) > 1 "
            "&& e > 2\n"
            "STRATEGY again 50 10\n"
            "ADAPTATION fleet_r1_amcl call /fleet/r1/reinitialize 5\n"
            "ADAPTATION fleet_r1_here call ~/go 5\n"
            "ADAPTATION fleet_r1_amcl change_communication scan /fleet/r1/scan 5\n");
}

TEST(Expansion, NamespacesNest) {
  EXPECT_EQ(plain("TEMPLATE arm\n  COMPONENT arm NODE /arm\nEND\n"
                  "TEMPLATE robot\n  COMPONENT base NODE /base\n  USE arm IN /left\n"
                  "  USE arm IN /right\nEND\nUSE robot IN /r1\n"),
            "COMPONENT r1_base NODE /r1/base\nCOMPONENT r1_left_arm NODE /r1/left/arm\n"
            "COMPONENT r1_right_arm NODE /r1/right/arm\n");
}

TEST(Expansion, AComponentOfATemplateGivesWayToTheSameNode) {
  const std::string nav =
      "TEMPLATE nav\n  COMPONENT planner NODE /planner_server\n  COMPONENT amcl NODE /amcl\n"
      "  DEPENDENCY planner ON amcl\nEND\n";
  EXPECT_EQ(plain("COMPONENT my_planner NODE /planner_server UNIT planner.service\n"
                  "COMPONENT amcl\n" +
                  nav + "USE nav\n"),
            "COMPONENT my_planner NODE /planner_server UNIT planner.service\nCOMPONENT amcl\n"
            "DEPENDENCY my_planner ON amcl\n");
  // Also to that of another template; not to another node.
  EXPECT_EQ(plain(nav + "TEMPLATE amcl\n  COMPONENT localiser NODE /amcl\n"
                        "  DEPENDENCY localiser ON lidar\nEND\nUSE nav\nUSE amcl\n"),
            "COMPONENT planner NODE /planner_server\nCOMPONENT amcl NODE /amcl\n"
            "DEPENDENCY planner ON amcl\nDEPENDENCY amcl ON lidar\n");
  EXPECT_EQ(check(expanded("COMPONENT amcl NODE /other\n" + nav + "USE nav\n")).diagnostics.size(),
            1u);
}

TEST(Expansion, RulesOfTwoNamespacesGoTogether) {
  const Expansion rules = expanded(kDriver +
                                   "COMPONENT lidar NODE /lidar\n"
                                   "USE driver(lidar, /scan) IN /r1\n"
                                   "USE driver(lidar, /scan) IN /r2\n");
  const Checked checked = check(rules, Strictness::kStrict);
  EXPECT_EQ(messages(rules, checked.diagnostics), "");
  ASSERT_TRUE(checked.rules);
  EXPECT_EQ(checked.rules->rules.at(1).name, "r2_lidar_slow");
}

// The place of a diagnostic and of what it leads to: "file:line:column".
std::vector<std::string> places(const Expansion& rules, const Diagnostic& diagnostic) {
  const LocatedDiagnostic here = located(diagnostic, rules.source);
  std::vector<std::string> all;
  const auto add = [&](const Place& place) {
    const Source& file = rules.source.file(place.file);
    const Position at = file.position(place.span.begin);
    all.push_back(file.name() + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) +
                  " " + std::string(file.text(place.span)));
  };
  add(here.place);
  for (const auto& note : here.notes) add(note.place);
  return all;
}

TEST(Expansion, MistakesPointWhereTheyAreWritten) {
  const Files files = {{"driver.rules", kDriver},
                       {"two.rules",
                        "INCLUDE \"driver.rules\"\nTEMPLATE two(side)\n"
                        "  USE driver({side}, /{side}/scan)\nEND\n"}};
  const Expansion rules = expanded("INCLUDE \"two.rules\"\nUSE two(left)\n", files);
  const auto diagnostics = check(rules, Strictness::kStrict).diagnostics;
  ASSERT_EQ(diagnostics.size(), 1u);
  // The argument goes through both templates, and is written where the outer one is used.
  EXPECT_EQ(places(rules, diagnostics[0]),
            (std::vector<std::string>{"robot.rules:2:9 left", "driver.rules:7:20 {name}"}));
}

TEST(Expansion, MistakesOfATemplateLeadToItsUse) {
  const Files files = {{"a.rules",
                        "TEMPLATE slow(name)\n  RULE r\n    POLICIES ERROR\n"
                        "    TRIGGER rate(/t, \"x\") < 1\n      STRATEGY s 50 10\n"
                        "        ADAPTATION {name} restart 5\nEND\nUSE slow(c)\n"}};
  const Expansion rules = expanded("INCLUDE \"a.rules\"\nUSE slow(d)\n", files);
  const auto diagnostics = check(rules).diagnostics;
  ASSERT_EQ(diagnostics.size(), 2u);  // and the rule is there twice
  EXPECT_EQ(places(rules, diagnostics[0]),
            (std::vector<std::string>{"a.rules:4:22 \"x\"", "a.rules:8:1 USE slow(c)",
                                      "robot.rules:1:1 INCLUDE \"a.rules\""}));
}

TEST(Expansion, FixesArePutWhereTheyAreWritten) {
  const Expansion rules =
      expanded("COMPONENT lidar NODE /lidar\n" + kDriver + "USE driver(lidra, /scan)\n");
  const auto diagnostics = check(rules).diagnostics;
  ASSERT_EQ(diagnostics.size(), 1u);
  const auto fix = located(diagnostics[0], rules.source).fix;
  ASSERT_TRUE(fix);
  std::string text(rules.source.file(0).text());
  text.replace(fix->span.begin, fix->span.end - fix->span.begin, fix->text);
  EXPECT_TRUE(check(expanded(text)).diagnostics.empty()) << text;
}

TEST(Expansion, ACheckOfATextFindsItsTemplates) {
  const Checked checked =
      check(Source("t.rules", kDriver + "USE driver(lidar, /scan)\nUSE driver(camera, /t, x)\n"));
  ASSERT_EQ(checked.diagnostics.size(), 1u);
  EXPECT_EQ(checked.diagnostics[0].code, Code::kNotConstant);
}

TEST(Expansion, EndsWhateverTemplatesDo) {
  // Each twice the one before: more than fits anywhere.
  std::string text = "TEMPLATE t0\n  CONST c = 1\nEND\n";
  for (int i = 1; i < 40; ++i) {
    const std::string before = "  USE t" + std::to_string(i - 1) + "\n";
    text += "TEMPLATE t" + std::to_string(i) + "\n";
    for (int n = 0; n < 2; ++n) text += before;
    text += "END\n";
  }
  const Expansion deep = expanded(text + "USE t39\n");
  ASSERT_FALSE(deep.mistakes.empty());
  EXPECT_EQ(deep.mistakes[0].code, Code::kEndlessTemplate);
  EXPECT_LE(deep.mistakes.size(), 200u);
}

// Said once, where it becomes too much, however much comes after it.
TEST(Expansion, EndsWhereItBecomesTooMuch) {
  const auto said = [](const std::string& text) {
    const Expansion rules = expanded(text);
    return messages(rules, rules.mistakes);
  };
  std::string wide = "TEMPLATE t0\n  CONST c = 1\nEND\n";
  for (int i = 1; i < 8; ++i) {
    wide += "TEMPLATE t" + std::to_string(i) + "\n";
    for (int n = 0; n < 10; ++n) wide += "  USE t" + std::to_string(i - 1) + "\n";
    wide += "END\n";
  }
  EXPECT_THAT(said(wide + "USE t7\nUSE t7\n"), HasSubstr("to more than 10000 USEs"));
  EXPECT_EQ(expanded(wide + "USE t7\nUSE t7\n").mistakes.size(), 1u);

  std::string rules = "TEMPLATE many(name)\n";
  for (int i = 0; i < 101; ++i)
    rules += "  RULE {name}_" + std::to_string(i) + "\n    POLICIES ERROR\n    TRIGGER true\n";
  rules += "END\n";
  for (int i = 0; i < 100; ++i) rules += "USE many(n" + std::to_string(i) + ")\n";
  EXPECT_THAT(said(rules), HasSubstr("to more than 10000 rules"));

  std::string holes;
  for (int i = 0; i < 1000; ++i) holes += "{a}";
  std::string texts = "TEMPLATE large(a)\n  COMPONENT c LAUNCH \"" + holes + "\"\nEND\n";
  for (int i = 0; i < 25; ++i) texts += "USE large(" + std::string(200, 'x') + ")\n";
  EXPECT_THAT(said(texts), HasSubstr("to more than 4 MiB of text"));

  std::string names = "TEMPLATE names\n";
  for (int i = 0; i < 10'000; ++i)
    names += "  SIGNAL s" + std::to_string(i) + " TOPIC /t FIELD data\n";
  names += "END\nUSE names IN /" + std::string(250, 'n') + "\n";
  EXPECT_THAT(said(names), HasSubstr("to more than 4 MiB of text"));
}

// The expanded text has no statements of reuse left, and every byte of it has an origin.
RC_GTEST_PROP(Expansion, OfWhateverIsWritten, ()) {
  const std::string text = random_rule_text().text;
  const Expansion rules =
      expanded(text, {{"packs/nav2.rules", random_rule_text().text}, {"a \"b\".rules", kDriver}});
  if (rules.mistakes.empty()) RC_ASSERT(!has_reuse(rules.source));
  const auto size = static_cast<std::uint32_t>(rules.source.text().size());
  for (std::uint32_t at = 0; at < size; ++at) {
    const Origin origin = rules.source.origin({at, at + 1});
    const Source& file = rules.source.file(origin.place.file);
    RC_ASSERT(origin.place.span.end <= file.text().size());
    if (origin.is_exact) RC_ASSERT(file.text(origin.place.span) == rules.source.text({at, at + 1}));
  }
  for (const Diagnostic& d : check(rules).diagnostics) RC_ASSERT(!render(d, rules.source).empty());
}

}  // namespace
}  // namespace culprit
