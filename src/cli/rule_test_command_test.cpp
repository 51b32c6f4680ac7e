#include <filesystem>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>

#include "cli/commands.h"

namespace culprit::cli {
namespace {

int run(const std::vector<std::string>& arguments) {
  CLI::App app;
  int exit_code = -1;
  add_test(app, exit_code);
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  reversed.emplace_back("test");
  app.parse(reversed);
  return exit_code;
}

std::string write(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path, std::ios::binary) << text;
  return path.string();
}

std::string failing_test() {
  const std::string rules = std::filesystem::absolute("rules/sunset.rules").string();
  return write("failing.test",
               "RULES " + rules + "\nTEST t\n  RUN 1s\n  EXPECT RGBDead DETECTED\n");
}

TEST(TestCommand, TellsByItsExitCodeWhetherAllHeld) {
  EXPECT_EQ(run({"rules/tests/sunset.test"}), kOk);
  EXPECT_EQ(run({"rules/tests/sunset.test", failing_test()}), kFailed);
  EXPECT_EQ(run({"rules/tests/sunset.test", "no/such.test"}), kFailed);
  EXPECT_EQ(run({"--filter", "no such test", "rules/tests/sunset.test"}), kUsage)
      << "a filter that takes no test proves nothing";
}

TEST(TestCommand, WritesJunit) {
  const std::string junit = write("junit.xml", "");
  EXPECT_EQ(run({"--junit", junit, failing_test()}), kFailed);
  std::ifstream in(junit);
  const std::string xml(std::istreambuf_iterator<char>(in), {});
  EXPECT_NE(xml.find("<testsuites tests=\"1\" failures=\"1\""), std::string::npos) << xml;
  EXPECT_NE(xml.find("EXPECT RGBDead DETECTED: it did not happen"), std::string::npos) << xml;
  EXPECT_EQ(run({"--junit", "no/such/folder/junit.xml", failing_test()}), kFailed);
}

}  // namespace
}  // namespace culprit::cli
