#include "exemplars/suave/model/pipeline.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::suave::model {
namespace {

TEST(Pipeline, LiesAsTheExemplars) {
  EXPECT_DOUBLE_EQ(pipeline().front().x, -15.5);
  EXPECT_DOUBLE_EQ(pipeline().front().y, 0);
  EXPECT_DOUBLE_EQ(pipeline().back().x, -51.56);
  EXPECT_DOUBLE_EQ(pipeline().back().y, -15.14);
  double length = 0.5;
  for (std::size_t i = 1; i < kPipelinePoints; ++i)
    length +=
        std::hypot(pipeline()[i].x - pipeline()[i - 1].x, pipeline()[i].y - pipeline()[i - 1].y);
  EXPECT_NEAR(length, 42.61, 0.01);
}

TEST(Pipeline, IsInspectedThereAndBack) {
  const auto path = inspection_path(4);
  EXPECT_EQ(path.size(), 96u + 100u);
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i)
    length += std::hypot(path[i].x - path[i - 1].x, path[i].y - path[i - 1].y);
  EXPECT_NEAR(length, 82.2, 0.1);
}

// How wide the camera sees from the altitudes of the search, and what that needs.
TEST(Detection, SeesAsWideAsItIsHigh) {
  struct Case {
    double height, altitude, above, reach;
  };
  for (const Case& c : {Case{0.75, 1, 0.25, 0.144}, Case{0.75, 2, 1.25, 0.722},
                        Case{0.75, 3, 2.25, 1.299}, Case{0, 1, 1, 0.577}, Case{0, 3, 3, 1.732}}) {
    const auto from = [&](double aside) { return Position{-30, aside, kSeabed + c.altitude}; };
    EXPECT_TRUE(seen_point(from(c.reach - 0.001), c.height, c.above));
    EXPECT_FALSE(seen_point(from(c.reach + 0.001), c.height, c.above));
    EXPECT_FALSE(seen_point(from(0), c.height, c.above - 0.001));
  }
}

RC_GTEST_PROP(Detection, GivesTheFirstPointOfThoseInReach, ()) {
  const auto number = [](double low, double high) {
    return low + (high - low) * *rc::gen::inRange(0, 1000) / 1000.0;
  };
  const Position camera{number(-55, -10), number(-17, 3), number(-20, -16)};
  const auto seen = seen_point(camera, 0.75, 10);
  const double reach = std::abs(camera.z + 19.25) * kSeenPerMetre;
  const std::size_t end = seen.value_or(kPipelinePoints);
  for (std::size_t i = 0; i < end; ++i) RC_ASSERT(!is_near(pipeline()[i], camera, reach));
  if (seen) RC_ASSERT(is_near(pipeline()[*seen], camera, reach));
}

}  // namespace
}  // namespace culprit::suave::model
