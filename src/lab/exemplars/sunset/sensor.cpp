#include "exemplars/sunset/sensor.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "exemplars/sunset/camera.h"

namespace culprit::sunset {
namespace {

// A binomial kernel, 1 2 1 along both axes. The border repeats.
RgbImage through_lens(const RgbImage& view) {
  RgbImage result(view.size);
  for (int y = 0; y < view.size.height; ++y) {
    const int above = std::max(y - 1, 0);
    const int below = std::min(y + 1, view.size.height - 1);
    for (int x = 0; x < view.size.width; ++x) {
      const int left = std::max(x - 1, 0);
      const int right = std::min(x + 1, view.size.width - 1);
      const auto mixed = [&](std::uint8_t Rgb::*channel) {
        const auto row = [&](int line) {
          return view.at(left, line).*channel + 2 * (view.at(x, line).*channel) +
                 view.at(right, line).*channel;
        };
        return static_cast<std::uint8_t>((row(above) + 2 * row(y) + row(below) + 8) / 16);
      };
      result.at(x, y) = {mixed(&Rgb::r), mixed(&Rgb::g), mixed(&Rgb::b)};
    }
  }
  return result;
}

// Binomial noise of zero mean, from the lowest `kBits` random bits; its variance is kBits / 4.
template <unsigned kBits>
int noise(std::uint64_t bits) {
  constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
  return std::popcount(bits & kMask) - static_cast<int>(kBits / 2);
}

std::uint8_t exposed(std::uint8_t channel, std::uint64_t bits) {
  return static_cast<std::uint8_t>(std::clamp(channel + noise<20>(bits), 0, 255));
}

}  // namespace

RgbImage photograph(const RgbImage& view, simulation::Random random) {
  RgbImage picture = through_lens(view);
  for (Rgb& pixel : picture.pixels) {
    const std::uint64_t bits = random.next();
    pixel = {exposed(pixel.r, bits), exposed(pixel.g, bits >> 20U), exposed(pixel.b, bits >> 40U)};
  }
  return picture;
}

DepthImage measure_depth(const Image<float>& height, simulation::Random random) {
  DepthImage depth(height.size);
  std::transform(height.pixels.begin(), height.pixels.end(), depth.pixels.begin(),
                 [&](float metres) {
                   const double distance = kAltitudeMetres - static_cast<double>(metres);
                   const int counts = static_cast<int>(distance / kDepthMetresPerCount + 0.5);
                   return static_cast<std::uint16_t>(counts + noise<16>(random.next()));
                 });
  return depth;
}

}  // namespace culprit::sunset
