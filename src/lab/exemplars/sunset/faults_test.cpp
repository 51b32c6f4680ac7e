#include "exemplars/sunset/faults.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "simulation/random.h"

namespace culprit::sunset {
namespace {

constexpr double kScenarioDegradation = 1.5;

RgbImage random_picture(std::uint64_t seed, Size size = {}) {
  simulation::Random random(seed);
  RgbImage picture(size);
  for (Rgb& pixel : picture.pixels) {
    const std::uint64_t bits = random.next();
    pixel = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8U),
             static_cast<std::uint8_t>(bits >> 16U)};
  }
  return picture;
}

RgbImage plain_picture(Rgb colour, Size size = {}) {
  RgbImage picture(size);
  std::fill(picture.pixels.begin(), picture.pixels.end(), colour);
  return picture;
}

DepthImage plain_depth(std::uint16_t counts) {
  DepthImage depth{Size{}};
  std::fill(depth.pixels.begin(), depth.pixels.end(), counts);
  return depth;
}

RC_GTEST_PROP(Degrade, ByNothingIsTheIdentity, (std::uint64_t seed)) {
  const RgbImage picture = random_picture(seed);
  RC_ASSERT(degrade(picture, 0) == picture);
}

TEST(Degrade, ByTheScenariosValueLeavesAQuarter) {
  EXPECT_EQ(degrade(plain_picture({255, 100, 3}), kScenarioDegradation),
            plain_picture({63, 25, 0}));
}

TEST(Degrade, WrapsAndSurvivesAnyParameter) {
  const RgbImage picture = plain_picture({255, 100, 0});
  EXPECT_EQ(degrade(picture, 4), plain_picture({1, 156, 0}));  // times -1, modulo 256
  EXPECT_EQ(degrade(picture, std::numeric_limits<double>::infinity()), plain_picture({0, 0, 0}));
  EXPECT_EQ(degrade(picture, std::numeric_limits<double>::quiet_NaN()), plain_picture({0, 0, 0}));
  EXPECT_NO_THROW(degrade(picture, 1e300));
}

RC_GTEST_PROP(Enhance, UndoesTheScenariosDegradationButForTwoBits, (std::uint64_t seed)) {
  const RgbImage picture = random_picture(seed);
  RgbImage coarse = picture;
  for (Rgb& pixel : coarse.pixels) {
    pixel = {static_cast<std::uint8_t>(pixel.r & 0xfcU), static_cast<std::uint8_t>(pixel.g & 0xfcU),
             static_cast<std::uint8_t>(pixel.b & 0xfcU)};
  }
  RC_ASSERT(enhance(degrade(picture, kScenarioDegradation)) == coarse);
}

TEST(Enhance, WrapsTheBrightPixelsOfAHealthyPicture) {
  EXPECT_EQ(enhance(plain_picture({63, 64, 130})), plain_picture({252, 0, 8}));
}

RC_GTEST_PROP(Shift, ByNothingOrLessIsTheIdentity, (std::uint64_t seed)) {
  const RgbImage picture = random_picture(seed);
  RC_ASSERT(shift(picture, 0) == picture);
  RC_ASSERT(shift(picture, -300) == picture);
}

RC_GTEST_PROP(Shift, MovesEveryColumnAndLeavesBlackBehind, (std::uint64_t seed)) {
  const RgbImage picture = random_picture(seed);
  const int columns = *rc::gen::inRange(0, picture.size.width + 1);
  const RgbImage moved = shift(picture, columns * kExemplarWidth / picture.size.width);
  for (int y = 0; y < picture.size.height; ++y) {
    for (int x = 0; x < picture.size.width; ++x) {
      RC_ASSERT(moved.at(x, y) == (x < columns ? Rgb{} : picture.at(x - columns, y)));
    }
  }
}

TEST(Shift, IsCountedInTheExemplarsColumns) {
  const RgbImage moved = shift(plain_picture({9, 9, 9}), 300);
  EXPECT_EQ(moved.at(24, 0), Rgb{});
  EXPECT_EQ(moved.at(25, 0), (Rgb{9, 9, 9}));
}

TEST(Shift, BeyondThePictureLeavesNothing) {
  const RgbImage picture = plain_picture({9, 9, 9});
  EXPECT_EQ(shift(picture, std::numeric_limits<std::int64_t>::max()), plain_picture({}));
}

TEST(DepthNoise, OfNothingIsTheIdentity) {
  EXPECT_EQ(depth_noise(plain_depth(3277), 0, 1), plain_depth(3277));
}

TEST(DepthNoise, HasTheExemplarsMeanAndDeviation) {
  const DepthImage noisy = depth_noise(plain_depth(3277), 2.0, 1);
  double sum = 0;
  double squares = 0;
  for (const std::uint16_t counts : noisy.pixels) {
    sum += counts - 3277.0;
    squares += (counts - 3277.0) * (counts - 3277.0);
  }
  const double n = static_cast<double>(noisy.pixels.size());
  const double mean = sum / n;
  EXPECT_NEAR(mean, -16.0, 1.0);
  EXPECT_NEAR(std::sqrt(squares / n - mean * mean), 32.0, 1.0);
}

TEST(DepthNoise, WrapsBelowZero) {
  const DepthImage noisy = depth_noise(plain_depth(0), 2.0, 1);
  EXPECT_GT(*std::max_element(noisy.pixels.begin(), noisy.pixels.end()), 65'000);
}

TEST(DepthNoise, IsAFunctionOfItsSeed) {
  const DepthImage depth = plain_depth(3277);
  EXPECT_EQ(depth_noise(depth, 2.0, 5), depth_noise(depth, 2.0, 5));
  EXPECT_NE(depth_noise(depth, 2.0, 5), depth_noise(depth, 2.0, 6));
}

RC_GTEST_PROP(Defocus, LeavesAPlainPictureAlone, (std::uint8_t r, std::uint8_t g, std::uint8_t b)) {
  const RgbImage picture = plain_picture({r, g, b});
  RC_ASSERT(defocus(picture) == picture);
}

TEST(Defocus, SpreadsAPointByOnePixel) {
  RgbImage picture(Size{9, 9});
  picture.at(4, 4) = {255, 0, 0};
  const RgbImage blurred = defocus(picture);
  double weight = 0;
  double variance = 0;
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 9; ++x) {
      weight += blurred.at(x, y).r;
      variance += blurred.at(x, y).r * (x - 4) * (x - 4);
    }
  }
  EXPECT_NEAR(weight, 255.0, 8.0);
  EXPECT_NEAR(variance / weight, 1.0, 0.1);
}

}  // namespace
}  // namespace culprit::sunset
