#include "exemplars/sunset/daylight.h"

#include <algorithm>
#include <array>
#include <vector>

#include "simulation/random.h"

namespace culprit::sunset {
namespace {

// A shadow sinks so much (in height units) with each diagonal step: 0.566 m * tan(50 degrees).
constexpr int kShadowDrop = 11;

// A shadow's edge travels down the diagonals. The second lap lets shadows cross the torus' seam.
void cast_shadows(Terrain& terrain) {
  std::vector<int> above(kTerrainCells, 0);
  std::vector<int> row(kTerrainCells, 0);
  for (int y = 0; y < 2 * kTerrainCells; ++y) {
    for (int x = 0; x < kTerrainCells; ++x) {
      Cell& cell = terrain.at(x, y);
      const int shadow = above[static_cast<std::size_t>((x + kTerrainCells - 1) % kTerrainCells)];
      cell.sunlit = cell.height + 4 >= shadow;
      row[static_cast<std::size_t>(x)] = std::max<int>(cell.height, shadow) - kShadowDrop;
    }
    std::swap(above, row);
  }
}

// Smooth noise in [-1, 1] with a period of the whole terrain and features of `1 << kScale` cells.
class Patches {
 public:
  explicit Patches(std::uint64_t seed) {
    simulation::Random random(seed);
    for (float& value : lattice_) value = static_cast<float>(random.uniform(-1, 1));
  }

  float at(int x, int y) const {
    const float u = smooth(x & kFraction);
    const float v = smooth(y & kFraction);
    const int i = x >> kScale;
    const int j = y >> kScale;
    const float top = node(i, j) * (1 - u) + node(i + 1, j) * u;
    const float bottom = node(i, j + 1) * (1 - u) + node(i + 1, j + 1) * u;
    return top * (1 - v) + bottom * v;
  }

 private:
  static constexpr int kScale = 4;
  static constexpr int kNodes = kTerrainCells >> kScale;
  static constexpr int kFraction = (1 << kScale) - 1;

  static float smooth(int offset) {
    const float t = static_cast<float>(offset) / (1 << kScale);
    return t * t * (3 - 2 * t);
  }
  float node(int i, int j) const {
    return lattice_[static_cast<std::size_t>((j & (kNodes - 1)) * kNodes + (i & (kNodes - 1)))];
  }

  std::array<float, std::size_t{kNodes} * kNodes> lattice_{};
};

// How much a material's brightness varies: over metres, and from cell to cell.
struct Texture {
  float patches = 0;
  float grain = 0;
};
constexpr std::array<Texture, kLabelCount> kTextures = {{
    {0.04F, 0.03F},  // road
    {0.04F, 0.04F},  // pavement
    {0.03F, 0.04F},  // building
    {0.11F, 0.08F},  // grass
    {0.06F, 0.14F},  // tree
    {0.00F, 0.00F},  // vehicle: never part of the terrain
    {0.10F, 0.06F},  // ground
    {0.05F, 0.03F},  // water
}};

// Slopes that face the sun are brighter. `rise` is in height units over one diagonal step away from
// the sun.
float slope_light(int rise) { return 1.0F + 0.02F * static_cast<float>(std::clamp(rise, -12, 10)); }

std::uint8_t scaled(std::uint8_t channel, float factor) {
  return static_cast<std::uint8_t>(std::min(255.0F, static_cast<float>(channel) * factor));
}

Rgb scaled(Rgb colour, float factor) {
  return {scaled(colour.r, factor), scaled(colour.g, factor), scaled(colour.b, factor)};
}

}  // namespace

Rgb in_shadow(Rgb colour) {
  return {scaled(colour.r, 0.60F), scaled(colour.g, 0.64F), scaled(colour.b, 0.72F)};
}

void light(Terrain& terrain, std::uint64_t seed) {
  cast_shadows(terrain);
  const Patches patches(seed);
  simulation::Random random(simulation::mix(seed));
  for (int y = 0; y < kTerrainCells; ++y) {
    for (int x = 0; x < kTerrainCells; ++x) {
      Cell& cell = terrain.at(x, y);
      const Texture& texture = kTextures[index_of(cell.label)];
      const float grain = static_cast<float>(random.next() >> 40U) * 0x1p-23F - 1.0F;
      const float brightness = 1.0F + texture.patches * patches.at(x, y) + texture.grain * grain;
      const int rise = cell.height - terrain.at(x - 1, y - 1).height;
      cell.colour = cell.sunlit ? scaled(cell.colour, brightness * slope_light(rise))
                                : in_shadow(scaled(cell.colour, brightness));
    }
  }
}

}  // namespace culprit::sunset
