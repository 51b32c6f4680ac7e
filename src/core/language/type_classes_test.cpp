#include "language/type_classes.h"

#include <gtest/gtest.h>

namespace culprit {
namespace {

TEST(TypeClasses, LearnOfAllWhatTheyLearnOfOne) {
  TypeClasses types;
  const auto a = types.add(std::nullopt);
  const auto b = types.add(std::nullopt);
  const auto c = types.add(std::nullopt);
  const auto other = types.add(std::nullopt);
  types.unify(a, b);
  types.unify(c, b);
  types.learn(a, Type::kString);
  EXPECT_EQ(types.type_of(c), Type::kString);
  EXPECT_EQ(types.type_of(other), std::nullopt);
}

TEST(TypeClasses, KeepWhatTheFirstUseTold) {
  TypeClasses types;
  const auto number = types.add(Type::kDouble);
  const auto truth = types.add(std::nullopt);
  types.learn(truth, Type::kBool);
  types.learn(truth, Type::kString);
  types.unify(number, truth);
  EXPECT_EQ(types.type_of(truth), Type::kBool);
  EXPECT_EQ(types.type_of(number), Type::kDouble);
}

TEST(TypeClasses, TakeWholeNumbersForNumbersAndNoDurations) {
  TypeClasses types;
  const auto v = types.add(std::nullopt);
  types.learn(v, Type::kDuration);
  EXPECT_EQ(types.type_of(v), std::nullopt);
  types.learn(v, Type::kInt);
  EXPECT_EQ(types.type_of(v), Type::kDouble);
}

}  // namespace
}  // namespace culprit
