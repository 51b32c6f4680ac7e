#include "link/diagnostics_reading.h"

#include <chrono>

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::link {
namespace {

RuleSet rules_of(const std::string& text) {
  Checked checked = check(Source("test.rules", text));
  if (!checked.rules) throw std::runtime_error("bad rules: " + text);
  return std::move(*checked.rules);
}

// A rule about a declared signal, one that is looked up, and the level of a status.
RuleSet some_rules() {
  return rules_of(
      "COMPONENT motor NODE /motor\n"
      "SIGNAL heat DIAGNOSTIC motor KEY temperature\n"
      "RULE r\n  POLICIES ERROR REPORT\n"
      "  TRIGGER heat > 80 || motor_current > 9 || level(\"motor\") >= 2\n");
}

struct Read {
  explicit Read(const RuleSet& rules) : reading(rules) {
    reading.on_signal = [this, &rules](SignalId id, const std::string& text) {
      signals[rules[id].name] = text;
    };
    reading.on_level = [this](DiagnosticId, std::uint8_t level) { levels.push_back(level); };
    reading.on_status = [this](StatusHeard) { ++statuses; };
  }
  DiagnosticsReading reading;
  std::map<std::string, std::string> signals;
  std::vector<int> levels;
  int statuses = 0;
};

TEST(DiagnosticsReading, FindsSignalsByStatusAndKeyAndByTheirName) {
  const RuleSet rules = some_rules();
  Read read(rules);
  read.reading.read({{}, {{2, "motor", "", "m1", {{"temperature", "85"}, {"current", "3"}}}}});
  EXPECT_EQ(read.signals,
            (std::map<std::string, std::string>{{"heat", "85"}, {"motor_current", "3"}}));
  EXPECT_EQ(read.levels, std::vector<int>{2});
}

// Its name and each of its keys together would be half a terabyte.
TEST(DiagnosticsReading, IsNotBusyForLongWithAStatusThatIsMadeForThat) {
  const RuleSet rules = some_rules();
  Read read(rules);
  ros2::msg::DiagnosticStatus hostile{
      0, std::string(2'000'000, 'n'), "", std::string(2'000'000, 'h'), {}};
  hostile.values.resize(125'000);
  const auto began = std::chrono::steady_clock::now();
  read.reading.read({{}, {std::move(hostile)}});
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(5));
  EXPECT_TRUE(read.signals.empty());
}

}  // namespace
}  // namespace culprit::link
