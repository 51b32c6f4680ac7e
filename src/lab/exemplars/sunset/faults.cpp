#include "exemplars/sunset/faults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "simulation/random.h"

namespace culprit::sunset {
namespace {

// Reproduces numpy's cast from floating point on the exemplar's machines: truncated, then modulo
// the type's range; zero if not finite.
template <typename Unsigned>
Unsigned wrapping_cast(double value) {
  if (!std::isfinite(value)) return 0;
  constexpr double kRange = std::is_same_v<Unsigned, std::uint8_t> ? 0x1p8 : 0x1p16;
  const double rest = std::fmod(std::trunc(value), kRange);
  return static_cast<Unsigned>(rest < 0 ? rest + kRange : rest);
}

RgbImage multiply(const RgbImage& rgb, double factor) {
  std::array<std::uint8_t, 256> product;
  for (std::size_t value = 0; value < product.size(); ++value) {
    product[value] = wrapping_cast<std::uint8_t>(static_cast<double>(value) * factor);
  }
  RgbImage result(rgb.size);
  std::transform(rgb.pixels.begin(), rgb.pixels.end(), result.pixels.begin(), [&](Rgb pixel) {
    return Rgb{product[pixel.r], product[pixel.g], product[pixel.b]};
  });
  return result;
}

constexpr std::array kKernel = {1, 4, 6, 4, 1};  // variance 1
constexpr int kKernelSum = 16;

// One of the two passes of the blur: along (step_x, step_y), the border repeated.
RgbImage blur(const RgbImage& rgb, int step_x, int step_y) {
  RgbImage result(rgb.size);
  for (int y = 0; y < rgb.size.height; ++y) {
    for (int x = 0; x < rgb.size.width; ++x) {
      int r = kKernelSum / 2;
      int g = kKernelSum / 2;
      int b = kKernelSum / 2;
      for (int tap = 0; tap < static_cast<int>(kKernel.size()); ++tap) {
        const Rgb& pixel = rgb.at(std::clamp(x + (tap - 2) * step_x, 0, rgb.size.width - 1),
                                  std::clamp(y + (tap - 2) * step_y, 0, rgb.size.height - 1));
        const int weight = kKernel[static_cast<std::size_t>(tap)];
        r += weight * pixel.r;
        g += weight * pixel.g;
        b += weight * pixel.b;
      }
      result.at(x, y) = {static_cast<std::uint8_t>(r / kKernelSum),
                         static_cast<std::uint8_t>(g / kKernelSum),
                         static_cast<std::uint8_t>(b / kKernelSum)};
    }
  }
  return result;
}

}  // namespace

RgbImage degrade(const RgbImage& rgb, double image_degradation) {
  return multiply(rgb, 1.0 - 0.5 * image_degradation);
}

RgbImage enhance(const RgbImage& rgb, double image_degradation) {
  return multiply(rgb, 1.0 + 2.0 * image_degradation);
}

RgbImage shift(const RgbImage& rgb, std::int64_t image_shift) {
  const auto columns = static_cast<int>(std::clamp<std::int64_t>(image_shift, 0, kExemplarWidth) *
                                        rgb.size.width / kExemplarWidth);
  RgbImage result(rgb.size);
  for (int y = 0; y < rgb.size.height; ++y) {
    for (int x = columns; x < rgb.size.width; ++x) result.at(x, y) = rgb.at(x - columns, y);
  }
  return result;
}

DepthImage depth_noise(const DepthImage& depth, double depth_degradation, std::uint64_t seed) {
  simulation::Random random(seed);
  DepthImage result(depth.size);
  std::transform(depth.pixels.begin(), depth.pixels.end(), result.pixels.begin(),
                 [&](std::uint16_t count) {
                   const double noise = 16.0 * depth_degradation * (random.normal() - 0.5);
                   return wrapping_cast<std::uint16_t>(count + noise);
                 });
  return result;
}

RgbImage defocus(const RgbImage& rgb) { return blur(blur(rgb, 1, 0), 0, 1); }

}  // namespace culprit::sunset
