#include "rca_study/scenario_json.h"

#include <gtest/gtest.h>

#include "rca_study/generator.h"

namespace culprit::study::rca {
namespace {

std::string sample() { return to_json(generate({6, 2, 0.1, true}, 7)); }

std::string with(std::string text, const std::string& what, const std::string& instead) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), instead);
}

std::string complaint(const std::string& text) {
  const auto read = scenario_from_json(text);
  return read ? "" : read.error();
}

TEST(ScenarioFile, ComesBackAsItWasWritten) {
  for (const RcaSetting& setting : {RcaSetting{5, 1, 0, false}, RcaSetting{40, 10, 0.2, true}}) {
    const std::string text = to_json(generate(setting, 3));
    const auto read = scenario_from_json(text);
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(to_json(*read), text);
  }
}

TEST(ScenarioFile, IsRefusedWithThePlaceOfTheMistake) {
  const std::string text = sample();
  EXPECT_EQ(complaint("{"), "it is no JSON");
  EXPECT_EQ(complaint("{}"), "it is no scenario: its format is not \"culprit-rca 1\"");
  EXPECT_EQ(complaint(with(text, "\"c1\"", "\"C 1\"")),
            "components[1] is wrong: name is not made of a-z, 0-9 and _, or too long");
  EXPECT_EQ(complaint(with(text, "\"c1\"", "\"c0\"")),
            "components[1] is wrong: name 'c0' is there twice");
  EXPECT_EQ(complaint(with(text, "\"miss\": 0.1", "\"miss\": 1.5")),
            "components[0] is wrong: detector is wrong: miss is not between 0 and 1");
  EXPECT_EQ(complaint(with(text, "\"restart\"", "\"kick\"")),
            "components[0] is wrong: treatments[1] is wrong: repair 'kick' is none of those that "
            "there are");
  EXPECT_EQ(complaint(with(text, "\"publishers\": [\n    \"c0\"", "\"publishers\": [\n    \"x\"")),
            "topics[0] is wrong: component 'x' is not among the components");
  EXPECT_EQ(complaint(with(text, "\"at_s\"", "\"when\"")), "faults[0] is wrong: at_s is missing");
}

TEST(ScenarioFile, OfAnotherPartyIsReadWhateverItsNumbersAre) {
  const std::string text = sample();
  EXPECT_EQ(complaint(with(text, "\"reading_s\": 0.2", "\"reading_s\": 1e999")), "it is no JSON");
  EXPECT_EQ(complaint(with(text, "\"horizon_s\": 120.0", "\"horizon_s\": -1")),
            "horizon_s is not between 1 and 3600");
  EXPECT_EQ(complaint(with(text, "\"impact\": 2", "\"impact\": 0")),
            "components[0] is wrong: treatments[0] is wrong: impact is less than 1");
}

}  // namespace
}  // namespace culprit::study::rca
