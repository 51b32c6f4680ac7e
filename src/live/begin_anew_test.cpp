#include "live/begin_anew.h"

#include <gtest/gtest.h>

namespace culprit::live {
namespace {

TEST(BeginAnew, DoesTheSameAgainButStartsNothing) {
  const std::vector<std::string> next{"culprit", "run", "a.rules", "--web", "--launch=false"};
  EXPECT_EQ(arguments_of_next({"culprit", "run", "a.rules", "--launch", "--web"}), next);
  EXPECT_EQ(arguments_of_next({"culprit", "run", "a.rules", "--launch=true", "--web"}), next);
  EXPECT_EQ(arguments_of_next({"culprit", "run", "a.rules", "--web"}), next)
      << "it may stand in culprit.toml";
  EXPECT_EQ(arguments_of_next(next), next);
}

}  // namespace
}  // namespace culprit::live
