#include "rule_test/reader.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "rule_test/state.h"
#include "rule_test/test_suite.h"

namespace culprit::rule_test {
namespace {

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

std::string messages(const Source& source) {
  std::vector<Diagnostic> diagnostics;
  if (source.name().ends_with(".state")) {
    read_state(source, pipeline_rules(), diagnostics);
  } else {
    rule_files(source, diagnostics);
    read_suite(source, pipeline_rules(), diagnostics);
  }
  std::string out;
  for (const Diagnostic& d : diagnostics) out += render(d, source);
  return out;
}

// Each file in golden/ holds mistakes, and a file beside it holds the messages about them.
// CULPRIT_WRITE_GOLDEN=1 writes the present messages, for a person to read and commit.
TEST(Reader, SaysWhatTheGoldenFilesSay) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator("src/tools/rule_test/golden")) {
    if (entry.path().extension() == ".expected") continue;
    ++files;
    const Source source(entry.path().filename().string(), read_file(entry.path()));
    const auto expected = std::filesystem::path(entry.path()).replace_extension(".expected");
    if (std::getenv("CULPRIT_WRITE_GOLDEN") != nullptr)
      std::ofstream(expected, std::ios::binary) << messages(source);
    EXPECT_EQ(messages(source), read_file(expected)) << entry.path();
  }
  EXPECT_GT(files, 0);
}

TEST(Reader, TakesAValueWithoutATimeForTheOneFromTheStart) {
  std::vector<Diagnostic> diagnostics;
  const State state =
      read_state(Source("x.state", "TOPIC /rgb 10Hz 8s: silent\nSIGNAL blur -0.5\n"),
                 pipeline_rules(), diagnostics);
  EXPECT_TRUE(diagnostics.empty());
  ASSERT_EQ(state.scenario.courses.size(), 2u);
  const auto& rgb = state.scenario.courses[0].stretches;
  ASSERT_EQ(rgb.size(), 2u);
  EXPECT_EQ(rgb[0].from, Duration::zero());
  EXPECT_EQ(rgb[0].value, Value(10.0));
  EXPECT_EQ(rgb[1].from, std::chrono::seconds(8));
  EXPECT_EQ(state.scenario.courses[1].stretches.at(0).value, Value(-0.5));
}

TEST(Reader, SharesWhatStandsBeforeTheFirstTest) {
  std::vector<Diagnostic> diagnostics;
  const Suite suite =
      read_suite(Source("x.test",
                        "TOPIC /rgb 0s: 10Hz\nTEST a\nTOPIC /rgb 2s..3s: silent\nRUN 5s\n"
                        "EXPECT CameraDead DETECTED\nTEST b\nRUN 5s\nEXPECT NO STRATEGY\n"),
                 pipeline_rules(), diagnostics);
  EXPECT_TRUE(diagnostics.empty());
  ASSERT_EQ(suite.tests.size(), 2u);
  EXPECT_EQ(suite.shared.courses.size(), 1u);
  ASSERT_EQ(suite.tests[0].scenario.courses.size(), 1u);
  const Stretch& stretch = suite.tests[0].scenario.courses[0].stretches.at(0);
  EXPECT_EQ(stretch.from, std::chrono::seconds(2));
  EXPECT_EQ(stretch.until, std::chrono::seconds(3));
  EXPECT_FALSE(stretch.value);
  EXPECT_TRUE(suite.tests[1].scenario.courses.empty());
}

TEST(Reader, NamesTheComponentsOfAGroupThatStandsForOne) {
  const RuleSet rules = pipeline_rules("GROUP vision { camera } MANAGER fusion\n");
  std::vector<Diagnostic> diagnostics;
  read_suite(Source("x.test", "TEST t\n  AT 2s vision STATE inactive\n"), rules, diagnostics);
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_EQ(diagnostics[0].cause, "'vision' is a group, and no component");
  EXPECT_NE(diagnostics[0].remedy.find("camera"), std::string::npos);
}

}  // namespace
}  // namespace culprit::rule_test
