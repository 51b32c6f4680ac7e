// JSON that was not exported: each mistake has its place, and no statement is injected.
#include "rule_json/from_json.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::rule_json {
namespace {

using testing::HasSubstr;

std::string complaints_about(const std::string& json) {
  const auto rules = to_rules("x.json", json);
  EXPECT_FALSE(rules) << *rules;
  return rules ? "" : rules.error();
}

std::string document(const std::string& statements) {
  return R"({"version": 1, "statements": [)" + statements + "]}";
}

TEST(FromJson, LaysOutWhatAPersonWrote) {
  const auto rules = to_rules("x.json", document(R"(
    {"comment": "# why", "name": "R", "statement": "RULE"},
    {"statement": "POLICIES", "on_change": false, "attempts": 3, "criticality": "ERROR"},
    {"statement": "TRIGGER", "expression": "a>1"},
    {"statement": "STRATEGY", "name": "s", "probability": 50, "confidence": 10},
    {"statement": "ADAPTATION", "component": "c", "impact": 5, "type": "change_mode",
     "mode": "slow mode"})"));
  ASSERT_TRUE(rules) << rules.error();
  EXPECT_EQ(*rules, R"(RULE R  # why
  POLICIES ERROR ATTEMPTS 3
  TRIGGER a > 1
    STRATEGY s 50 10
      ADAPTATION c change_mode "slow mode" 5
)");
}

TEST(FromJson, SaysWhereItIsNoJson) {
  EXPECT_THAT(complaints_about("{\n  \"version\": ,\n"), HasSubstr("x.json:2:14: this is no JSON"));
  EXPECT_THAT(complaints_about(""), HasSubstr("x.json:1:1"));
  EXPECT_THAT(complaints_about("{\"version\": 1, \"version\": 1, \"statements\": []}"),
              HasSubstr("two members \"version\""));
  std::string many = "{\"a\": 1";
  for (int i = 0; i < 100'000; ++i) many += ", \"" + std::to_string(i) + "\": 1";
  EXPECT_THAT(complaints_about(many + "}"), HasSubstr("more than 64 members"));
  EXPECT_THAT(complaints_about("{\"version\": 1e999, \"statements\": []}"),
              HasSubstr("this is no JSON"));
  EXPECT_THAT(complaints_about("\"\xff\""), HasSubstr("this is no JSON"));
  EXPECT_THAT(complaints_about(std::string(100'000, '[')), HasSubstr("this is no JSON"));
  EXPECT_THAT(complaints_about("{\"version\": " + std::string(1'000'000, '[') +
                               std::string(1'000'000, ']') + ", \"statements\": []}"),
              HasSubstr("it is nested deeper than any statement"));
}

TEST(FromJson, SaysWhatADocumentIs) {
  EXPECT_THAT(complaints_about("[]"), HasSubstr("x.json: the document: this is no object"));
  EXPECT_THAT(complaints_about("{\"statements\": []}"), HasSubstr("x.json: /version: "));
  EXPECT_THAT(complaints_about("{\"version\": 2, \"statements\": []}"), HasSubstr("/version: "));
  EXPECT_THAT(complaints_about("{\"version\": 1}"), HasSubstr("/statements: "));
  EXPECT_THAT(complaints_about("{\"version\": 1, \"statements\": [], \"statments\": []}"),
              HasSubstr("/statments: there is no such member; did you mean 'statements'?"));
  EXPECT_THAT(complaints_about("{\"version\": 1, \"statements\": [], \"end\": [\"x\"]}"),
              HasSubstr("/end/0: this is no line of comment"));
}

// One statement, and the message about it.
TEST(FromJson, SaysWhichMemberIsWrongAndWhatItHasToBe) {
  const std::vector<std::pair<const char*, const char*>> cases = {
      {R"(1)", "/statements/0: this is no object"},
      {R"({})", "/statements/0/statement: there is no statement ''; known: ROBOT"},
      {R"({"statement": "RULES"})",
       "/statements/0/statement: there is no statement 'RULES'; "
       "did you mean 'RULE'?"},
      {R"({"statement": "RULE"})", "/statements/0/name: this member is missing"},
      {R"({"statement": "RULE", "name": 1})", "/statements/0/name: this must be a text of letters"},
      {R"({"statement": "RULE", "name": "STRATEGY"})", "/statements/0: 'STRATEGY' is a word"},
      {R"({"statement": "RULE", "name": "r", "nmae": 1})",
       "/statements/0/nmae: this statement has no such member; did you mean 'name'?"},
      {R"({"statement": "RULE", "name": "r", "a/b~c": 1})", "/statements/0/a~1b~0c: "},
      {R"({"statement": "RULE", "name": "r", "above": ""})", "/statements/0/above: this must be"},
      {R"({"statement": "RULE", "name": "r", "comment": "why"})",
       "/statements/0/comment: this is no comment"},
      {R"({"statement": "TRIGGER", "expression": "a > 1"})",
       "/statements/0: TRIGGER belongs to a RULE"},
      {R"({"statement": "CONST", "name": "a", "value": "1 +"})",
       "/statements/0/value: a value is missing behind '+'"},
      {R"({"statement": "CONST", "name": "a", "value": 1})",
       "/statements/0/value: this must be a text with one expression"},
      {R"({"statement": "CYCLE", "length": "200"})",
       "/statements/0/length: this must be a duration"},
      {R"({"statement": "IGNORE", "topics": []})", "/statements/0/topics: this must be names"},
      {R"({"statement": "IGNORE", "topics": ["a"]})", "/statements/0: 'a' is no full ROS name"},
      {R"({"statement": "SIGNAL", "name": "s", "topic": "/t"})",
       "/statements/0/field: this member is missing"},
      {R"({"statement": "SIGNAL", "name": "s", "topic": "/t", "field": "f", "range": [1]})",
       "/statements/0/range: this must be two numbers"},
      {R"({"statement": "ADAPTATION", "component": "c", "type": "restrat", "impact": 1})",
       "/statements/0/type: there is no adaptation 'restrat'; did you mean 'restart'?"},
      {R"({"statement": "ADAPTATION", "component": "c", "type": "restart", "mode": "m",
           "impact": 1})",
       "/statements/0/mode: this statement has no such member"},
      {R"({"statement": "STRATEGY", "name": "s", "probability": -1, "confidence": 1})",
       "/statements/0/probability: this must be a number that is not negative"},
      {R"({"statement": "STRATEGY", "name": "s", "probability": 18446744073709551615,
           "confidence": 1})",
       "/statements/0/probability: this must be"},
  };
  for (const auto& [statement, said] : cases)
    EXPECT_THAT(complaints_about(document(statement)), HasSubstr(said)) << statement;
}

TEST(FromJson, LetsNothingBeSlippedIntoAnotherPart) {
  const std::vector<const char*> statements = {
      R"({"statement": "RULE", "name": "r\nRULE x"})",
      R"({"statement": "RULE", "name": "r # x"})",
      R"({"statement": "RULE", "name": "r", "comment": "# a\nRULE x"})",
      R"({"statement": "RULE", "name": "r", "above": ["# a\nRULE x"]})",
      R"({"statement": "CONST", "name": "a", "value": "1 # x"})",
      R"({"statement": "CONST", "name": "a", "value": "1 2"})",
      R"({"statement": "CONST", "name": "a", "value": "1\n"})",
      R"({"statement": "CYCLE", "length": "1s # x"})",
      R"({"statement": "COMPONENT", "name": "a", "launch": "\"a\" NODE /x"})",
      R"({"statement": "COMPONENT", "name": "a", "launch": "\"a\nb\""})",
      R"({"statement": "COMPONENT", "name": "a", "node": "\"/a\" LAUNCH"})",
      R"({"statement": "COMPONENT", "name": "a", "unit": "\"a.service\" REQUIRED"})",
      R"({"statement": "COMPONENT", "name": "a", "user": true})",
      R"({"statement": "IGNORE", "topics": ["/a /b"]})",
  };
  for (const char* statement : statements)
    EXPECT_THAT(complaints_about(document(statement)), HasSubstr("/statements/0")) << statement;
}

}  // namespace
}  // namespace culprit::rule_json
