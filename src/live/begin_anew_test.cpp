#include "live/begin_anew.h"

#include <gtest/gtest.h>

namespace culprit::live {
namespace {

TEST(BeginAnew, DoesTheSameAgainButStartsNothing) {
  EXPECT_EQ(arguments_of_next({"culprit", "run", "a.rules", "--launch", "--web"}),
            (std::vector<std::string>{"culprit", "run", "a.rules", "--web"}));
}

}  // namespace
}  // namespace culprit::live
