#include "exemplars/sunset/pictures.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "exemplars/sunset/scene.h"

namespace culprit::sunset {
namespace {

const ros2::msg::Header kHeader{{12, 300'000'000}, "drone"};

TEST(Pictures, ComeBackFromTheWireAsTheyWere) {
  const Frame frame = Scene(1, Size{32, 24}).frame(0);
  EXPECT_EQ(rgb_of(to_message(frame.rgb, kHeader)), frame.rgb);
  EXPECT_EQ(depth_of(to_message(frame.depth, kHeader)), frame.depth);
  EXPECT_EQ(labels_of(to_message(frame.truth, kHeader)), frame.truth);
}

TEST(Pictures, AreInTheExemplarsEncodings) {
  RgbImage rgb(Size{2, 1});
  rgb.pixels = {{1, 2, 3}, {4, 5, 6}};
  const auto message = to_message(rgb, kHeader);
  EXPECT_EQ(message.encoding, "bgr8");
  EXPECT_EQ(message.data, (std::vector<std::uint8_t>{3, 2, 1, 6, 5, 4}));
  EXPECT_EQ(message.step, 6U);
  EXPECT_EQ(message.header, kHeader);
  EXPECT_EQ(to_message(DepthImage(Size{2, 1}), kHeader).encoding, "16UC1");
  EXPECT_EQ(to_message(LabelImage(Size{2, 1}), kHeader).encoding, "8UC1");
}

TEST(Pictures, OfNoSizeStandForNone) {
  EXPECT_EQ(rgb_of({}), RgbImage());
  EXPECT_EQ(depth_of(to_message(DepthImage(), kHeader)), DepthImage());
}

TEST(Pictures, OfOtherEncodingsAreNotRead) {
  auto message = to_message(RgbImage(Size{2, 2}), kHeader);
  EXPECT_FALSE(depth_of(message));
  message.encoding = "rgb8";
  EXPECT_FALSE(rgb_of(message));
}

// A stranger can say anything: what is read must be as large as it says.
RC_GTEST_PROP(Pictures, AreReadOnlyIfTheyAreWhole,
              (std::uint32_t width, std::uint32_t height, std::uint32_t step,
               const std::vector<std::uint8_t>& data)) {
  ros2::msg::Image message;
  message.encoding = "16UC1";
  message.width = width;
  message.height = height;
  message.step = step;
  message.data = data;
  if (const auto picture = depth_of(message)) {
    RC_ASSERT(picture->pixels.size() * sizeof(std::uint16_t) == data.size());
    RC_ASSERT(picture->pixels.size() == std::size_t{width} * height);
  }
}

}  // namespace
}  // namespace culprit::sunset
