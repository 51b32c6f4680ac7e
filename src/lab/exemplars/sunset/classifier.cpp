#include "exemplars/sunset/classifier.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>

#include "exemplars/sunset/camera.h"
#include "exemplars/sunset/scene.h"

namespace culprit::sunset {
namespace {

constexpr std::uint64_t kTrainingSeed = 0x5eed0000U;
constexpr std::uint64_t kTrainingTowns = 4;
constexpr std::uint64_t kTrainingFrames = 20;  // of each town
constexpr std::uint64_t kTrainingStride = 61;  // frames; 37 m of flight

constexpr float kPriorWeight = 10.0F;  // a, in pixels
constexpr float kDoubt = 0.014F;       // e

// Colours in steps of 8 grey levels on each channel.
constexpr unsigned kColourBits = 5;
constexpr std::size_t kColourBins = std::size_t{1} << (3 * kColourBits);

std::size_t colour_bin(Rgb colour) {
  const auto step = [](std::uint8_t channel) { return std::size_t{channel} >> (8 - kColourBits); };
  return step(colour.r) << (2 * kColourBits) | step(colour.g) << kColourBits | step(colour.b);
}

// Heights in steps of 0.75 m, about half a car's; bin 0 is below the ground.
constexpr double kHeightStep = 0.75;
constexpr std::size_t kHeightBins = 24;

std::size_t height_bin(std::uint16_t depth) {
  const double height = kAltitudeMetres - depth * kDepthMetresPerCount;
  const double bin = std::floor(height / kHeightStep + 1.0);
  return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kHeightBins - 1)));
}

// Median of a pixel and its four neighbours, so that single bad readings do not count. The border
// repeats.
std::uint16_t median_depth(const DepthImage& depth, int x, int y) {
  std::array<std::uint16_t, 5> readings = {
      depth.at(x, y),
      depth.at(std::max(x - 1, 0), y),
      depth.at(std::min(x + 1, depth.size.width - 1), y),
      depth.at(x, std::max(y - 1, 0)),
      depth.at(x, std::min(y + 1, depth.size.height - 1)),
  };
  std::nth_element(readings.begin(), readings.begin() + 2, readings.end());
  return readings[2];
}

void scale(Distribution& counts, float factor) {
  for (float& count : counts) count *= factor;
}

float total(const Distribution& counts) {
  return std::accumulate(counts.begin(), counts.end(), 0.0F);
}

// Turns an expert's counts into its probabilities.
void fit(std::vector<Distribution>& expert, const Distribution& prior) {
  for (Distribution& bin : expert) {
    const float seen = total(bin) + kPriorWeight;
    for (std::size_t label = 0; label < kLabelCount; ++label) {
      const float smoothed = (bin[label] + kPriorWeight * prior[label]) / seen;
      bin[label] = (1.0F - kDoubt) * smoothed + kDoubt * prior[label];
    }
  }
}

}  // namespace

Classifier::Classifier() : colour_expert_(kColourBins), height_expert_(kHeightBins) {
  for (std::uint64_t town = 0; town < kTrainingTowns; ++town) {
    const Scene scene(kTrainingSeed + town);
    for (std::uint64_t number = 0; number < kTrainingFrames; ++number) {
      const Frame frame = scene.frame(number * kTrainingStride);
      for (int y = 0; y < frame.truth.size.height; ++y) {
        for (int x = 0; x < frame.truth.size.width; ++x) {
          const std::size_t label = index_of(frame.truth.at(x, y));
          ++prior_[label];
          ++colour_expert_[colour_bin(frame.rgb.at(x, y))][label];
          ++height_expert_[height_bin(median_depth(frame.depth, x, y))][label];
        }
      }
    }
  }
  scale(prior_, 1.0F / total(prior_));
  fit(colour_expert_, prior_);
  fit(height_expert_, prior_);
}

Image<Distribution> Classifier::probabilities(const RgbImage& rgb, const DepthImage& depth) const {
  if (!rgb.empty() && !depth.empty() && rgb.size != depth.size) {
    throw std::invalid_argument("Classifier: the colour and the depth image differ in size");
  }
  Image<Distribution> result(rgb.empty() ? depth.size : rgb.size);
  for (int y = 0; y < result.size.height; ++y) {
    for (int x = 0; x < result.size.width; ++x) {
      const Distribution& by_colour =
          rgb.empty() ? prior_ : colour_expert_[colour_bin(rgb.at(x, y))];
      const Distribution& by_height =
          depth.empty() ? prior_ : height_expert_[height_bin(median_depth(depth, x, y))];
      Distribution& fused = result.at(x, y);
      for (std::size_t label = 0; label < kLabelCount; ++label) {
        fused[label] = by_colour[label] * by_height[label] / prior_[label];
      }
      scale(fused, 1.0F / total(fused));
    }
  }
  return result;
}

LabelImage most_likely(const Image<Distribution>& probabilities) {
  LabelImage result(probabilities.size);
  std::transform(
      probabilities.pixels.begin(), probabilities.pixels.end(), result.pixels.begin(),
      [](const Distribution& pixel) {
        return static_cast<Label>(std::max_element(pixel.begin(), pixel.end()) - pixel.begin());
      });
  return result;
}

double entropy(const Image<Distribution>& probabilities) {
  if (probabilities.empty()) return 0;
  double sum = 0;
  for (const Distribution& pixel : probabilities.pixels) {
    float bits = 0;
    for (const float p : pixel) bits -= p * std::log2(std::max(p, 1e-10F));
    sum += static_cast<double>(bits);
  }
  return sum / static_cast<double>(probabilities.pixels.size() * kLabelCount);
}

}  // namespace culprit::sunset
