// Rule text -> JSON -> rule text: nothing gets lost.
#include <filesystem>
#include <fstream>
#include <memory>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/utils/nlohmann_json_utils.hpp>
#include <valijson/validator.hpp>

#include "language/formatter.h"
#include "language/parser.h"
#include "language/test_rules.h"
#include "language/test_tree.h"
#include "rule_json/from_json.h"
#include "rule_json/to_json.h"

namespace culprit::rule_json {
namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

std::string tree_of(const std::string& text) {
  std::vector<Diagnostic> diagnostics;
  const Source source("test.rules", text);
  const std::string tree = tree_text(parse(source, diagnostics));
  return diagnostics.empty() ? tree : render(diagnostics.front(), source);
}

std::string exported(const std::string& rules) {
  const auto json = to_json(Source("test.rules", rules));
  EXPECT_TRUE(json) << json.error();
  return json ? to_text(*json) : "";
}

std::string imported(const std::string& json) {
  const auto rules = to_rules("test.json", json);
  EXPECT_TRUE(rules) << rules.error() << json;
  return rules ? *rules : "";
}

// The complaints of the published schema about `json`; empty if there are none.
std::string schema_complaints(const std::string& json) {
  static const auto kSchema = [] {
    auto schema = std::make_unique<valijson::Schema>();
    const nlohmann::json text = parse_json(read("docs/rules.schema.json"));
    valijson::SchemaParser(valijson::SchemaParser::kDraft7)
        .populateSchema(valijson::adapters::NlohmannJsonAdapter(text), *schema);
    return schema;
  }();
  const nlohmann::json document = parse_json(json);  // what valijson reads
  valijson::ValidationResults results;
  const valijson::adapters::NlohmannJsonAdapter target(document);
  if (valijson::Validator().validate(*kSchema, target, &results)) return "";
  std::string all = json;
  for (valijson::ValidationResults::Error error; results.popError(error);) {
    for (const std::string& part : error.context) all += part;
    all += ": " + error.description + "\n";
  }
  return all;
}

std::vector<std::filesystem::path> shipped_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator("rules")) {
    if (entry.path().extension() == ".rules") files.push_back(entry.path());
  }
  return files;
}

TEST(RuleJson, GivesShippedFilesBackByteForByte) {
  EXPECT_GT(shipped_files().size(), 10u);
  for (const auto& path : shipped_files()) {
    const std::string json = exported(read(path));
    EXPECT_EQ(imported(json), read(path)) << path;
    EXPECT_EQ(schema_complaints(json), "") << path;
  }
}

RC_GTEST_PROP(RuleJson, KeepsWhatTheRulesSay, ()) {
  const std::string rules = random_rule_text().text;
  RC_ASSERT(tree_of(imported(exported(rules))) == tree_of(rules));
}

// Comments, blank lines and spellings included.
RC_GTEST_PROP(RuleJson, GivesCanonicalTextBackByteForByte, ()) {
  const std::string canonical = *format(Source("test.rules", random_rule_text().text));
  RC_ASSERT(imported(exported(canonical)) == canonical);
}

RC_GTEST_PROP(RuleJson, IsWhatTheSchemaSays, ()) {
  RC_ASSERT(schema_complaints(exported(random_rule_text().text)) == "");
}

// So that the schema is one that can say no.
TEST(RuleJson, IsNotWhateverTheSchemaIsGiven) {
  for (const char* statement : {
           R"({"statement": "RULES", "name": "r"})",
           R"({"statement": "RULE"})",
           R"({"statement": "RULE", "name": "r", "nmae": 1})",
           R"({"statement": "RULE", "name": "r", "comment": "why"})",
           R"({"statement": "CYCLE", "length": "200"})",
           R"({"statement": "SIGNAL", "name": "s", "topic": "/t"})",
           R"({"statement": "ADAPTATION", "component": "c", "type": "call", "impact": 1})",
       }) {
    const std::string json = std::string(R"({"version": 1, "statements": [)") + statement + "]}";
    EXPECT_NE(schema_complaints(json), "") << statement;
  }
  EXPECT_EQ(schema_complaints(R"({"version": 1, "statements": []})"), "");
  EXPECT_NE(schema_complaints(R"({"version": 2, "statements": []})"), "");
}

TEST(RuleJson, HoldsEachPartByItsName) {
  const auto json = to_json(Source("test.rules", R"(# head
COMPONENT fusion NODE /robot/fusion LAUNCH "run \"it\""  # the one
SIGNAL entropy DIAGNOSTIC "the status" KEY k FROM fusion STALE 2s RANGE -0.5..1

RULE Bad
  POLICIES WARNING HOLD 3/5 ON_CHANGE
  TRIGGER entropy>.06
    STRATEGY s 80.5 1e1 WHEN alive(fusion)
      ADAPTATION fusion set_parameter gain -1 * 2 3
# end
)"));
  ASSERT_TRUE(json) << json.error();
  const Json expected = parse_json(R"j({
    "version": 1,
    "statements": [
      {"statement": "COMPONENT", "name": "fusion", "node": "/robot/fusion",
       "launch": "run \"it\"", "comment": "# the one", "above": ["# head"]},
      {"statement": "SIGNAL", "name": "entropy", "diagnostic": "the status", "key": "k",
       "from": "fusion", "stale": "2s", "range": [-0.5, 1]},
      {"statement": "RULE", "name": "Bad", "above": [""]},
      {"statement": "POLICIES", "criticality": "WARNING", "hold": [3, 5], "on_change": true},
      {"statement": "TRIGGER", "expression": "entropy>.06"},
      {"statement": "STRATEGY", "name": "s", "probability": 80.5, "confidence": "1e1",
       "when": "alive(fusion)"},
      {"statement": "ADAPTATION", "component": "fusion", "type": "set_parameter",
       "parameter": "gain", "value": "-1 * 2", "impact": 3}
    ],
    "end": ["# end"]
  })j");
  EXPECT_EQ(*json, expected);
}

// The text between the first line ```<kind> of docs/rule-json.md and the next ```.
std::string documented(const std::string& kind) {
  const std::string page = read("docs/rule-json.md");
  const std::string open = "\n```" + kind + "\n";
  const std::size_t begin = page.find(open) + open.size();
  return page.substr(begin, page.find("```\n", begin) - begin);
}

TEST(RuleJson, IsAsDocumented) { EXPECT_EQ(exported(documented("")), documented("json")); }

TEST(RuleJson, SaysWhatACheckSaysOfTextThatDoesNotParse) {
  const auto json = to_json(Source("bad.rules", "RULE\n"));
  ASSERT_FALSE(json);
  EXPECT_NE(json.error().find("bad.rules:1:5: error[R002]"), std::string::npos) << json.error();
}

TEST(RuleJson, RefusesTextThatIsNotUtf8) {
  const auto json = to_json(Source("bad.rules", "# fine\n# k\xfchl\n"));
  ASSERT_FALSE(json);
  EXPECT_NE(json.error().find("bad.rules:2: this line is not UTF-8"), std::string::npos)
      << json.error();
}

}  // namespace
}  // namespace culprit::rule_json
