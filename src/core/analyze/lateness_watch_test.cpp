#include "analyze/lateness_watch.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;
using Statement = Latencies::Statement;

constexpr Time kDetected{100s};

RuleSet rules_of_a_fork() {
  std::string text = "CYCLE 200ms\n";
  for (const std::string name : {"a", "b", "c", "d"}) {
    text += "COMPONENT " + name + " NODE /" + name + "\nSIGNAL " + name + "_ill DIAGNOSTIC " +
            name + " KEY ill\n";
  }
  for (const std::string name : {"b", "c", "d"}) text += "DEPENDENCY " + name + " ON a\n";
  for (const std::string name : {"a", "b", "c", "d"}) {
    text += "RULE " + name + "_fails\nPOLICIES ERROR\nTRIGGER " + name +
            "_ill == true\nSTRATEGY s 90 10\nADAPTATION " + name + " restart 2\n";
  }
  return *check(Source("x.rules", text)).rules;
}

// b, c and d depend on a, which failed. Monitors are late by at most 400 ms, as the rules state it.
class Fork : public ::testing::Test {
 protected:
  Fork() : rules_(rules_of_a_fork()), knowledge_(rules_), watch_(knowledge_, knowledge_.latencies) {
    for (const char* node : {"/a", "/b", "/c", "/d"}) knowledge_.graph.node_appeared(node);
    for (const char* name : {"b_fails", "c_fails", "d_fails"})
      state(name).detection.trigger = Slot::of(false);
    fail("a_fails", 0s);
  }

  static RuleId rule(std::string_view name) {
    return RuleId(static_cast<std::size_t>(name[0] - 'a'));
  }
  RuleState& state(std::string_view name) { return knowledge_.states.state(rule(name)); }
  void fail(std::string_view name, Duration after) {
    state(name).failing_since = kDetected + after;
    knowledge_.states.enter(rule(name), RulePhase::kFailing);
  }
  Statement after(Duration time) {
    watch_.advance(kDetected + time);
    return knowledge_.latencies.statement();
  }

  RuleSet rules_;
  Knowledge knowledge_;
  LatenessWatch watch_;
};

TEST_F(Fork, NothingIsKnownAtFirst) { EXPECT_EQ(after(0s), Statement::kUnproven); }

TEST_F(Fork, ConsumersThatFailSoonShowPromptMonitors) {
  fail("b_fails", 400ms);
  fail("c_fails", 600ms);
  EXPECT_EQ(after(700ms), Statement::kKept);
}

TEST_F(Fork, ConsumersThatFailLateShowSlowMonitors) {
  EXPECT_EQ(after(1s), Statement::kUnproven);
  fail("b_fails", 1900ms);
  fail("c_fails", 2400ms);
  EXPECT_EQ(after(2500ms), Statement::kExceeded);
}

// The producer's monitor may be the slow one.
TEST_F(Fork, ConsumersThatFailFirstShowSlowMonitors) {
  for (const char* name : {"b_fails", "c_fails", "d_fails"}) fail(name, -1500ms);
  EXPECT_EQ(after(200ms), Statement::kExceeded);
}

TEST_F(Fork, WhatARepairTouchedShowsNothing) {
  state("a_fails").attempt.emplace();
  fail("b_fails", 1900ms);
  EXPECT_EQ(after(2s), Statement::kUnproven);
}

TEST_F(Fork, AnOldFailureShowsNothing) {
  fail("b_fails", 1h);
  EXPECT_EQ(after(1h + 1s), Statement::kUnproven);
}

TEST_F(Fork, RulesWithALearnedLatenessNeedNoStatement) {
  for (const char* name : {"a_fails", "b_fails"})
    knowledge_.latencies.set(rule(name), {1, {2s, 2s, 2s}});
  knowledge_.latencies.weigh(-10);
  fail("b_fails", 1900ms);
  EXPECT_EQ(after(2s), Statement::kKept);
}

}  // namespace
}  // namespace culprit
