// Pictures as plain values: a size and its pixels, row by row from the top left.
//
// How the live nodes send them: pictures.h. At the default size one frame fits one UDP datagram.
// Pixels that come from elsewhere may hold any byte where a Label is expected.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace culprit::sunset {

struct Size {
  int width = 160;
  int height = 120;
  bool operator==(const Size&) const = default;
};

template <typename Pixel>
struct Image {
  Size size{0, 0};
  std::vector<Pixel> pixels;

  Image() = default;
  explicit Image(Size s)
      : size(s), pixels(static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height)) {}

  bool empty() const { return pixels.empty(); }
  Pixel& at(int x, int y) { return pixels[index(x, y)]; }
  const Pixel& at(int x, int y) const { return pixels[index(x, y)]; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
           static_cast<std::size_t>(x);
  }
  bool operator==(const Image&) const = default;
};

struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb&) const = default;
};
static_assert(sizeof(Rgb) == 3);

// The class of a pixel. The metrics of SUNSET's evaluator map to them so: "road" is kRoad (asphalt
// and its markings). "vehicle" (there the mean over rider, car, truck, bus, train, motorcycle,
// bicycle) is kVehicle.
enum class Label : std::uint8_t {
  kRoad,
  kPavement,  // sidewalks, parking lots, bridges' and canals' kerbs
  kBuilding,
  kGrass,
  kTree,
  kVehicle,
  kGround,  // bare soil, paths
  kWater,
};
inline constexpr int kLabelCount = 8;

constexpr std::size_t index_of(Label label) { return static_cast<std::size_t>(label); }

using RgbImage = Image<Rgb>;
using DepthImage = Image<std::uint16_t>;
using LabelImage = Image<Label>;

// The depth encoding of the exemplar's data set (SynDrone, as rendered by CARLA): 16 bits span 1000
// m along the optical axis, so one count is 15.3 mm.
inline constexpr double kDepthMetresPerCount = 1000.0 / 65535.0;

}  // namespace culprit::sunset
