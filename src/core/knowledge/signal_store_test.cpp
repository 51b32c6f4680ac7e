#include "knowledge/signal_store.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

TEST(SignalStore, ARuleIsReadWhenAllThatItReadsIs) {
  const RuleSet rules = *check(Source("x.rules",
                                      "COMPONENT c NODE /c\nRULE R\nPOLICIES ERROR\nTRIGGER x > 1 "
                                      "|| y > 1\nSTRATEGY s 90 10\nADAPTATION c restart 5\n"))
                             .rules;
  SignalStore store(rules);
  const Time since{10s};
  store.set_read_at(InputId(0), since + 1s);
  EXPECT_FALSE(store.is_read_since(RuleId(0), since));
  store.set_read_at(InputId(1), since);
  EXPECT_FALSE(store.is_read_since(RuleId(0), since)) << "then is not since then";
  store.set_read_at(InputId(1), since + 1ns);
  EXPECT_TRUE(store.is_read_since(RuleId(0), since));
}

TEST(SignalStore, ARuleIsLookedAtOnceHoweverManyOfItsInputsChanged) {
  const RuleSet rules = *check(Source("x.rules",
                                      "COMPONENT c NODE /c\nRULE R\nPOLICIES ERROR\nTRIGGER x > 1 "
                                      "|| y > 1\nSTRATEGY s 90 10\nADAPTATION c restart 5\n"))
                             .rules;
  SignalStore store(rules);
  (void)store.take_touched();
  store.touch(InputId(0));
  store.touch(InputId(1));
  EXPECT_EQ(store.take_touched().size(), 1u);
}

TEST(SignalStore, OnlyOneAndZeroAreTruthValues) {
  std::string text;
  EXPECT_TRUE(as_type(Value(std::int64_t{1}), Type::kBool, text).b);
  EXPECT_TRUE(as_type(Value(std::int64_t{0}), Type::kBool, text).known);
  EXPECT_FALSE(as_type(Value(std::int64_t{2}), Type::kBool, text).known);
  EXPECT_FALSE(as_type(Value(1.0), Type::kBool, text).known);
  EXPECT_TRUE(as_type(Value(std::string("true")), Type::kBool, text).b);
}

}  // namespace
}  // namespace culprit
