// The edits that diagnostics offer to programs.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "language/test_example_robot.h"
#include "live_checks/live_checks.h"

namespace culprit {
namespace {

std::string with(const Edit& edit, const Source& source) {
  std::string text(source.text());
  return text.replace(edit.span.begin, edit.span.end - edit.span.begin, edit.text);
}

// The text after the fix of its first diagnostic that has one; empty if none has.
std::string fixed(const std::string& text, Strictness strictness = Strictness::kLenient) {
  const Source source("test.rules", text);
  for (const Diagnostic& d : check(source, strictness).diagnostics) {
    if (d.fix) return with(*d.fix, source);
  }
  return "";
}

TEST(Fixes, PutWordsRight) {
  EXPECT_EQ(fixed("robot sunset\n"), "ROBOT sunset\n");
  EXPECT_EQ(fixed("alert Blurred\n"), "RULE Blurred\n");
  EXPECT_EQ(fixed("COMPONENT c NOED /c\n"), "COMPONENT c NODE /c\n");
  EXPECT_EQ(fixed("SIGNAL e DIAGNOSTIC s key e\n"), "SIGNAL e DIAGNOSTIC s KEY e\n");
  EXPECT_EQ(fixed("RULE: r\n"), "RULE r\n");
}

std::string rule_file(const std::string& trigger, const std::string& strategy = "STRATEGY s 50 10",
                      const std::string& adaptation = "ADAPTATION c restart 5",
                      const std::string& policies = "POLICIES ERROR") {
  return "COMPONENT c\nRULE r\n" + policies + "\nTRIGGER " + trigger + "\n" + strategy + "\n" +
         adaptation + "\n";
}

// The remedy for the first mistake of the text.
std::string remedy(const std::string& text) {
  const Checked checked = check(Source("test.rules", text));
  return checked.diagnostics.empty() ? "" : checked.diagnostics.front().remedy;
}

TEST(Fixes, FitHurriedDeclarations) {
  EXPECT_EQ(fixed("CONST hot = 75,5\n"), "CONST hot = 75.5\n");
  EXPECT_EQ(fixed("CONST hot = 75.0 -- degrees\n"), "CONST hot = 75.0 # degrees\n");
  EXPECT_EQ(fixed("COMPONENT NODE lidar /lidar\n"), "COMPONENT lidar NODE /lidar\n");
  EXPECT_EQ(fixed("SIGNAL s TOPIC /t FIELD .data\n"), "SIGNAL s TOPIC /t FIELD data\n");
  EXPECT_EQ(fixed("TEMPLATE t(hz: 10)\nEND\n"), "TEMPLATE t(hz = 10)\nEND\n");
  EXPECT_EQ(fixed("TEMPLATE t(hz 10)\nEND\n"), "TEMPLATE t(hz = 10)\nEND\n");
  EXPECT_EQ(fixed("CONST hot = 75.0 /* degrees\n"), "CONST hot = 75.0 # degrees\n");
  EXPECT_EQ(fixed("12: ROBOT sunset\n"), "ROBOT sunset\n");
  EXPECT_EQ(remedy("SIGNAL s TOPIC /t FIELD cells[-1]\n"), "write its number, as in ranges[0]");
  EXPECT_EQ(remedy("DEPENDENCY ON lidar fusion\n"),
            "write the component that needs the other one first: DEPENDENCY fusion ON camera");
}

TEST(Fixes, FitHurriedRules) {
  const std::string right = rule_file("x > 1", "STRATEGY s 50 10", "ADAPTATION c restart 5",
                                      "POLICIES ERROR COOLDOWN 10s");
  const auto policies = [](const std::string& cooldown) {
    return fixed(rule_file("x > 1", "STRATEGY s 50 10", "ADAPTATION c restart 5",
                           "POLICIES ERROR COOLDOWN " + cooldown));
  };
  EXPECT_EQ(policies("00:00:10"), right);
  EXPECT_EQ(policies("00:10"), right);
  const auto trigger = [](const std::string& wrong) { return fixed(rule_file(wrong)); };
  EXPECT_EQ(trigger("rate(\"/scan) < 8"), rule_file("rate(/scan) < 8"));
  EXPECT_EQ(trigger("goals(/go, 1min, aborted) > 3"), rule_file("goals(/go, aborted, 1min) > 3"));
  EXPECT_EQ(trigger("logs(c, 10s, ERROR) > 3"), rule_file("logs(c, ERROR, 10s) > 3"));
  EXPECT_EQ(trigger("logs(c, ERROR, 1d) > 3"), rule_file("logs(c, ERROR, 24h) > 3"));
  EXPECT_EQ(remedy(rule_file("lifecycle(c) =~ \"inactive|finalized\"")),
            "compare with each: x == \"a\" || x == \"b\"");
  EXPECT_EQ(remedy(rule_file("lifecycle(c) == \"deactivated\"")), "write \"inactive\"");
  EXPECT_EQ(fixed(rule_file("x > 1", "STRATEGY s 50 10 WEHN alive(c)")),
            rule_file("x > 1", "STRATEGY s 50 10 WHEN alive(c)"));
  const auto adaptation = [](const std::string& written) {
    return rule_file("x > 1", "STRATEGY s 50 10", "ADAPTATION c set_parameter p " + written);
  };
  EXPECT_EQ(fixed(adaptation("0,4 5")), adaptation("0.4 5"));
  EXPECT_EQ(fixed(adaptation("0.4m/s 5")), adaptation("0.4 5"));
  EXPECT_EQ(remedy(rule_file("rate(/scan) < 8", "STRATEGY s 50 10 WHEN alive(/scan)")),
            "write the component that publishes it");
}

TEST(Fixes, PutExpressionsRight) {
  const auto becomes = [](const std::string& wrong, const std::string& right) {
    EXPECT_EQ(fixed(rule_file(wrong)), rule_file(right));
  };
  becomes("x > 1 and y < 2", "x > 1 && y < 2");
  becomes("x > 1 & y < 2", "x > 1 && y < 2");
  becomes("x > 1 or y < 2", "x > 1 || y < 2");
  becomes("x > 1 | y < 2", "x > 1 || y < 2");
  becomes("not docked", "!docked");
  becomes("not (docked)", "!(docked)");
  becomes("x = 3", "x == 3");
  becomes("rats(/t) < 1", "rate(/t) < 1");
  becomes("(x > 1", "(x > 1)");
  becomes("alive(c  # is it?", "alive(c)  # is it?");
  becomes("mode == 'dock'", "mode == \"dock\"");
  becomes("mode == \"dock  ", "mode == \"dock\"  ");
  becomes("lifecycle(c) == active", "lifecycle(c) == \"active\"");
}

TEST(Fixes, PutRulesRight) {
  const std::string good = rule_file("x > 1");
  EXPECT_EQ(fixed(rule_file("x > 1", "STRATEGY s 50% 10")), good);
  EXPECT_EQ(fixed(rule_file("x > 1", "STRATEGY s 50%10")), good);
  EXPECT_EQ(fixed(rule_file("x > 1", "STRATEGY s 0.5 10")), good);
  EXPECT_EQ(fixed(rule_file("x > 1", "STRATEGY s 50 10", "ADAPTATION c restrat 5")), good);
  EXPECT_EQ(fixed(rule_file("x > 1", "STRATEGY s 50 10", "ADAPTATION c action_restart 5")), good);
  EXPECT_EQ(
      fixed(rule_file("x > 1", "STRATEGY s 50 10", "ADAPTATION c restart 5", "POLICIES CRITICAL")),
      good);
  EXPECT_EQ(
      fixed(rule_file("x > 1", "STRATEGY s 50 10", "ADAPTATION c restart 5",
                      "POLICIES ERROR FOR 2 s")),
      rule_file("x > 1", "STRATEGY s 50 10", "ADAPTATION c restart 5", "POLICIES ERROR FOR 2s"));
}

TEST(Fixes, PutNamesRight) {
  const std::string head = "COMPONENT camera\nSIGNAL entropy DIAGNOSTIC s KEY entropy\n";
  EXPECT_EQ(fixed(head + rule_file("entropi > 1")), head + rule_file("entropy > 1"));
  EXPECT_EQ(fixed(head + rule_file("alive(camrea) == false")),
            head + rule_file("alive(camera) == false"));
  EXPECT_EQ(fixed(head + rule_file("entropi > 1"), Strictness::kStrict),
            head + rule_file("entropy > 1"));
}

TEST(Fixes, AreNotOfferedWhereMoreThanOneIsLikely) {
  EXPECT_EQ(fixed("CYCLE 200\n"), "") << "which unit?";
  EXPECT_EQ(fixed(rule_file("x > 1", "STRATEGY s 0.001 10")), "") << "a tenth of a percent?";
  EXPECT_EQ(fixed(rule_file("mode == 'it\"s'")), "");
  EXPECT_EQ(fixed(rule_file("age(image) > 1s")), "") << "in which namespace?";
}

TEST(Fixes, StayInTheirLineAtTheEndOfAFile) {
  const std::string text =
      "COMPONENT c\nRULE r\n  POLICIES ERROR\n  TRIGGER age(/t) > 1s\n    STRATEGY s 50 10\n"
      "      ADAPTATION c set_parameter p to";
  int fixes = 0;
  for (const Diagnostic& d : check(Source("t.rules", text)).diagnostics) {
    if (!d.fix) continue;
    ++fixes;
    EXPECT_LE(d.fix->span.end, text.size());
  }
  EXPECT_GT(fixes, 0);
}

// Over everything that people wrote wrong.
TEST(Fixes, RemoveWhatTheyAreOfferedFor) {
  int applied = 0;
  for (const auto& entry : std::filesystem::directory_iterator("src/core/language/golden")) {
    if (entry.path().extension() != ".rules") continue;
    std::ifstream in(entry.path(), std::ios::binary);
    const Source source(entry.path().filename().string(),
                        std::string(std::istreambuf_iterator<char>(in), {}));
    const auto checked = [&](const Source& text) {
      if (source.name().starts_with("live_"))
        return live_checks::check_against(example_robot(), text);
      const bool is_strict = source.name().starts_with("strict_");
      return check(text, is_strict ? Strictness::kStrict : Strictness::kLenient);
    };
    for (const Diagnostic& d : checked(source).diagnostics) {
      if (!d.fix) continue;
      ++applied;
      ASSERT_LE(d.fix->span.begin, d.fix->span.end) << render(d, source);
      ASSERT_LE(d.fix->span.end, source.text().size()) << render(d, source);
      // Text before the diagnostic does not change, so the diagnostic would be at the same place.
      ASSERT_GE(d.fix->span.begin, d.span.begin) << render(d, source);
      const Source after(source.name(), with(*d.fix, source));
      const auto left = checked(after).diagnostics;
      EXPECT_TRUE(std::none_of(left.begin(), left.end(),
                               [&](const Diagnostic& other) {
                                 return other.code == d.code && other.span.begin == d.span.begin;
                               }))
          << render(d, source) << "is not gone after '" << d.fix->text << "'";
    }
  }
  EXPECT_GT(applied, 20);
}

}  // namespace
}  // namespace culprit
