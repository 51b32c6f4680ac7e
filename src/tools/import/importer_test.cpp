#include "import/importer.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/checker.h"

namespace culprit::foreign {
namespace {

using testing::HasSubstr;

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

Expected<Imported> imported(const std::string& text) {
  return import_rules(Source("old.txt", text));
}

std::string strategies(const std::string& rules) {
  return "BEGIN CONSTS\nEND CONSTS\nBEGIN RULES\n" + rules + "END RULES\n";
}

std::string rule_with(const std::string& trigger, const std::string& adaptation) {
  return strategies("RULE r\nPOLICIES OK ON_TICK 1/1\nTRIGGER " + trigger +
                    "\nSTRATEGY s 100\nADAPTATION " + adaptation + "\n");
}

std::string conditions(const std::string& condition) {
  return strategies("RULE r\nCOMPONENTS [/a/b]\nIF " + condition + "\nTHEN action_restart\n");
}

std::string trigger_of(const std::string& text) {
  const auto result = imported(text);
  if (!result) return result.error();
  const auto begin = result->text.find("  TRIGGER ");
  return begin == std::string::npos
             ? result->text
             : result->text.substr(begin + 10, result->text.find('\n', begin) - begin - 10);
}

// Each .txt in golden/ is a file of the reference's kind; beside it what it becomes, and the notes.
// CULPRIT_WRITE_GOLDEN=1 writes what it becomes now, for a person to read and commit.
TEST(Importer, GivesWhatTheGoldenFilesSay) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator("src/tools/import/golden")) {
    if (entry.path().extension() != ".txt") continue;
    ++files;
    const Source source(entry.path().filename().string(), read_file(entry.path()));
    const auto result = import_rules(source);
    ASSERT_TRUE(result) << result.error();
    std::string said = result->text + "----\n";
    for (const Note& note : result->notes)
      said += std::to_string(note.line) + ": " + note.text + "\n";
    const auto expected = std::filesystem::path(entry.path()).replace_extension(".expected");
    if (std::getenv("CULPRIT_WRITE_GOLDEN") != nullptr)
      std::ofstream(expected, std::ios::binary) << said;
    EXPECT_EQ(said, read_file(expected)) << entry.path();
    EXPECT_TRUE(check(Source("imported.rules", result->text)).rules) << result->text;
  }
  EXPECT_GT(files, 0);
}

// In a comment of the import it would be a mistake that nothing takes away.
TEST(Importer, RefusesBinaryFiles) {
  using namespace std::string_literals;
  const auto imported = import_rules(Source("old.rules", "BEGIN RULES # \0\nEND RULES\n"s));
  ASSERT_FALSE(imported);
  EXPECT_EQ(imported.error(), "old.rules: this file is binary, not a rule file");
}

TEST(Importer, KeepsTheReferencesGrouping) {
  const auto trigger = [](const std::string& text) {
    return trigger_of(rule_with(text, "c restart"));
  };
  EXPECT_EQ(trigger("p || q && r"), "(p || q) && r");
  EXPECT_EQ(trigger("p && q || r"), "p && q || r");
  EXPECT_EQ(trigger("(x + 1) * 2 < 3 - (2 - 1)"), "(x + 1) * 2 < 3 - (2 - 1)");
  EXPECT_EQ(trigger("-x ^ 2 < +3"), "pow(-x, 2) < 3");
  EXPECT_EQ(trigger("x > 1 / 2"), "x > 1.0 * 1 / 2");
  EXPECT_EQ(trigger("!(x > 1.)"), "!(x > 1.0)");
}

TEST(Importer, JoinsConditionsAsTheyAreNested) {
  const auto trigger = [](const std::string& text) { return trigger_of(conditions(text)); };
  EXPECT_EQ(trigger("((a < b) AND (c > b) AND (d != b))"), "a < b && c > b && d != b");
  EXPECT_EQ(trigger("(((p == 1) OR (q == 1)) AND (r == 1))"), "(p == 1 || q == 1) && r == 1");
}

TEST(Importer, TellsConstantsFromMonitoredValues) {
  const auto result = imported(
      "BEGIN CONSTS\ndouble ns_image_freq 2.\ndouble camera_heat 0\ndouble camera_heat_limit 70\n"
      "END CONSTS\nBEGIN RULES\nRULE r\nPOLICIES OK ON_TICK 1/1\n"
      "TRIGGER ns_image_freq < 1 || camera_heat > camera_heat_limit\nSTRATEGY s 100\n"
      "ADAPTATION /ns/camera action_restart\nEND RULES\n");
  ASSERT_TRUE(result) << result.error();
  EXPECT_THAT(result->text,
              HasSubstr("TRIGGER rate(/ns/image) < 1 || camera_heat > camera_heat_limit\n"));
  EXPECT_THAT(result->text, HasSubstr("SIGNAL camera_heat DIAGNOSTIC camera KEY heat\n"));
  EXPECT_THAT(result->text, HasSubstr("CONST camera_heat_limit = 70.0\n"));
}

// Its monitoring overwrites such a constant; otherwise the rule would mean nothing.
TEST(Importer, TakesTheOnlyConstantThatATriggerReadsForASignal) {
  const auto result = imported(
      "BEGIN CONSTS\ndouble entropy 0.0\ndouble limit 0.06\nEND CONSTS\nBEGIN RULES\nRULE r\n"
      "POLICIES OK ON_TICK 1/1\nTRIGGER entropy > limit\nSTRATEGY s 100\n"
      "ADAPTATION /ns/camera action_restart\nEND RULES\n");
  ASSERT_TRUE(result) << result.error();
  EXPECT_EQ(result->rules, 1u);
  EXPECT_THAT(result->text, HasSubstr("CONST limit = 0.06\n"));
  EXPECT_THAT(result->text, testing::Not(HasSubstr("CONST entropy")));
}

TEST(Importer, GivesEveryActionItsName) {
  const struct {
    std::string written, becomes;
  } cases[] = {
      {"action_activate", "activate 10"},
      {"action_deactivate", "deactivate 10"},
      {"action_restart", "restart 25"},
      {"action_redeploy", "redeploy 50"},
      {"action_change_communication p \"/t\"", "change_communication p /t 2"},
      {"action_set_parameter p 1+2", "set_parameter p 1 + 2 1"},
      {"action_set_parameter p 1+2 9", "set_parameter p 1 + 2 9"},
      {"action_increase_parameter p 2", "increase_parameter p 2 1"},
      {"action_decrease_parameter p 2", "decrease_parameter p 2 1"},
      {"action_change_mode fast", "change_mode fast 1"},
  };
  for (const auto& [written, becomes] : cases) {
    const auto result = imported(rule_with("x > 1", "/n/c " + written));
    ASSERT_TRUE(result) << result.error();
    EXPECT_THAT(result->text, HasSubstr("\n      ADAPTATION c " + becomes + "\n"));
  }
}

TEST(Importer, SaysWhereAndWhyAFileCannotBeRead) {
  const struct {
    std::string text, error;
  } cases[] = {
      {"", "old.txt:1:1: this is no rule file of the reference"},
      {"RULE r\n  POLICIES WARNING\n", "if it is culprit's own, run culprit check"},
      {"BEGIN CONSTS\n", "old.txt:2:1: the file ends before END CONSTS"},
      {"BEGIN RULES\n", "old.txt:2:1: the file ends before END RULES"},
      {"END RULES\nBEGIN RULES\n", "old.txt:1:1: this marker is out of place"},
      {"BEGIN CONSTS\n  double x 1 2\n", "old.txt:2:3: a constant is three words"},
      {"BEGIN CONSTS\n  limit 1\n", "old.txt:2:3: a constant is three words"},
      {"BEGIN CONSTS\n float x 1\n", "old.txt:2:2: there is no type 'float'; known: bool"},
      {"BEGIN CONSTS\n double x ten\n", "old.txt:2:11: 'ten' is no number"},
      {"BEGIN CONSTS\n bool x yes\n", "old.txt:2:9: 'yes' is no bool; write true or false"},
      {"loose\nBEGIN RULES\n", "old.txt:1:1: this stands outside"},
      {strategies("RULE r\nPOLICES OK\n"), "did you mean POLICIES?"},
      {strategies("POLICIES OK ON_TICK 1/1\n"), "4:1: POLICIES belongs to a RULE"},
      {strategies("RULE r\nPOLICIES BAD ON_TICK 1/1\n"), "5:10: there is no level 'BAD'"},
      {strategies("RULE r\nPOLICIES OK ALWAYS 1/1\n"), "5:13: there is no policy 'ALWAYS'"},
      {strategies("RULE r\nPOLICIES OK ON_TICK 4/2\n"), "5:21: '4/2' is no filter"},
      {strategies("RULE r\nPOLICIES OK ON_TICK 1/1\nTRIGGER x > \n"), "a value is missing here"},
      {strategies("RULE r\nPOLICIES OK ON_TICK 1/1\nTRIGGER (x > 1\n"), "is never closed"},
      {strategies("RULE r\nPOLICIES OK ON_TICK 1/1\nTRIGGER f(x)\n"), "has no functions"},
      {strategies("RULE r\nPOLICIES OK ON_TICK 1/1\nTRIGGER x > 1 2\n"),
       "6:15: this text does not"},
      {strategies("RULE r\nPOLICIES OK ON_TICK 1/1\n"), "4:6: rule 'r' has no TRIGGER"},
      {strategies("RULE r\nPOLICIES OK ON_TICK 1/1\nTRIGGER x\nSTRATEGY s\n"), "a strategy has"},
      {strategies("RULE r\nPOLICIES OK ON_TICK 1/1\nTRIGGER x\nSTRATEGY s much\n"), "'much' is no"},
      {strategies("RULE r\nPOLICIES OK ON_TICK 1/1\nTRIGGER x\nADAPTATION c action_restart\n"),
       "an ADAPTATION belongs to a STRATEGY"},
      {rule_with("x", "c action_explode"), "8:14: there is no action 'action_explode'; known: "},
      {rule_with("x", "c action_set_parameter"), "action_set_parameter needs an argument"},
      {rule_with("x", "c action_restart now"), "8:29: this text does not belong to the line"},
      {conditions("a < b"), "6:4: a condition begins with '('"},
      {conditions("(a < b) AND (c < d)"), "6:12: this text does not belong to the condition"},
      {conditions("((a < b) AND (c < d) OR (e < f))"), "AND and OR stand in one pair"},
      {conditions("((a < b) XOR (c < d))"), "expected AND or OR, not 'XOR'"},
      {conditions("(a = b)"), "6:7: there is no operator '='"},
      {conditions("(a<b)"), "a comparison is three words"},
      {strategies("RULE r\nCOMPONENTS [/a/b]\nIF (a < b)\n"), "the end is out of place"},
      {strategies("RULE r\nCOMPONENTS /a/b\n"), "components stand in brackets"},
      {strategies("RULE r\nCOMPONENTS [/a]\nIF (a < b)\nTHEN action_set_parameter p\n"),
       "needs a parameter and a value"},
  };
  for (const auto& [text, error] : cases) {
    const auto result = imported(text);
    ASSERT_FALSE(result) << text << result->text;
    EXPECT_THAT(result.error(), HasSubstr(error)) << text;
  }
}

TEST(Importer, SurvivesHostileNesting) {
  for (const char* open : {"(", "!", "2(", "-", "x + ("}) {
    std::string expression;
    for (int i = 0; i < 50000; ++i) expression += open;
    EXPECT_FALSE(imported(rule_with(expression, "c restart")));
  }
  EXPECT_FALSE(imported(conditions(std::string(50000, '('))));
}

// Files made of the dialects' own words in a random order: the imported rules pass a check, and no
// rule gets lost.
RC_GTEST_PROP(Importer, WhatItGivesPassesACheck, ()) {
  const auto word = [](std::vector<std::string> words) {
    return *rc::gen::elementOf(std::move(words));
  };
  const std::vector<std::string> names{"a", "b", "camera_heat", "ns_scan_freq", "RULE", "limit"};
  std::string text = "BEGIN CONSTS\n";
  const int constants = *rc::gen::inRange(0, 4);
  for (int i = 0; i < constants; ++i) {
    const std::string type = word({"int", "double", "bool", "string"});
    text += type + " " + word(names) + " " + (type == "bool" ? "true" : "3") + "\n";
  }
  text += "END CONSTS\nBEGIN RULES\n";
  const int rules = *rc::gen::inRange(1, 6);
  for (int i = 0; i < rules; ++i) {
    text += "RULE " + word(names) + "\nPOLICIES " + word({"OK", "FAILURE"}) + " " +
            word({"ON_TICK", "ON_CHANGE"}) + " 1/" + word({"1", "3"}) + "\nTRIGGER " + word(names) +
            word({" < ", " == ", " && ", " / ", " ^ "}) + word(names) +
            word({"", " > 1", " || true"}) + "\n";
    const int strategies = *rc::gen::inRange(1, 3);
    for (int s = 0; s < strategies; ++s) {
      text += "STRATEGY " + word(names) + " " + word({"0", "50", "200"}) + "\n";
      const int adaptations = *rc::gen::inRange(0, 3);
      for (int a = 0; a < adaptations; ++a) {
        text += "ADAPTATION " + word({"/ns/camera", "/ns/lidar", "camera"}) + " " +
                word({"action_restart", "action_redeploy", "action_activate",
                      "action_set_parameter p a", "action_increase_parameter p limit 3",
                      "action_change_communication p b"}) +
                "\n";
      }
    }
    text += "\n";
  }
  text += "END RULES\n";
  const auto result = imported(text);
  RC_ASSERT(result.has_value());
  RC_ASSERT(check(Source("imported.rules", result->text)).rules.has_value());
  RC_ASSERT(result->rules + result->rules_as_comments == static_cast<std::size_t>(rules));
}

}  // namespace
}  // namespace culprit::foreign
