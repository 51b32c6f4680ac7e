#include "link/namesake.h"

#include <gtest/gtest.h>

namespace culprit::link {
namespace {

using namespace std::chrono_literals;

const Time kThen{100s};
const ros2::GraphNode kNamesake{"/culprit", ros2::Vendor::kFastDds, "rover2", 0};

TEST(Namesake, ThatStaysIsToldOnce) {
  Namesake namesake;
  EXPECT_FALSE(namesake.due(kThen));
  namesake.joined(kNamesake, kThen);
  EXPECT_FALSE(namesake.due(kThen + 1999ms));
  const auto told = namesake.due(kThen + 2s);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->find("another node is called /culprit, too, on rover2: "), 0u) << *told;
  EXPECT_FALSE(namesake.due(kThen + 4s));
}

TEST(Namesake, ThatIsLeavingIsNobodyElse) {
  Namesake namesake;
  namesake.joined(kNamesake, kThen);
  namesake.left();
  EXPECT_FALSE(namesake.due(kThen + 10s));
  namesake.joined(kNamesake, kThen + 20s);  // this one stays
  EXPECT_FALSE(namesake.due(kThen + 21s));
  EXPECT_TRUE(namesake.due(kThen + 22s));
}

}  // namespace
}  // namespace culprit::link
