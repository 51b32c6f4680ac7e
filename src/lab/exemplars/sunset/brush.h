// Brushes that paint one thing each onto a terrain: a surface, a house, a tree, a pond.
//
// Colours are those of the material in plain light; daylight.h adds sun, shadow and texture
// afterwards. Lengths are in cells, heights in metres.
#pragma once

#include "exemplars/sunset/terrain.h"
#include "simulation/random.h"

namespace culprit::sunset {

// Cells with x <= column < x + width and y <= row < y + height.
struct Rect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  Rect inset(int margin) const {
    return {x + margin, y + margin, width - 2 * margin, height - 2 * margin};
  }
};

struct Surface {
  Label label = Label::kGrass;
  Rgb colour;
  double height = 0;
};

void paint(Terrain& terrain, Rect area, const Surface& surface);

// A roof that rises from `eaves` on both sides to a ridge along the longer side.
void paint_gabled_house(Terrain& terrain, Rect area, double eaves, Rgb roof);

// A flat roof with a darker rim and a few technical boxes on it.
void paint_flat_building(Terrain& terrain, Rect area, double height, Rgb roof,
                         simulation::Random& random);

// A rounded, ragged crown; what stands higher already stays.
void paint_tree(Terrain& terrain, int x, int y, double height, simulation::Random& random);

// An ellipse that fills `area`, with a shore of bare soil.
void paint_pond(Terrain& terrain, Rect area);

inline constexpr Rgb kAsphalt{86, 87, 90};
inline constexpr Rgb kMarking{218, 219, 220};
inline constexpr Rgb kConcrete{188, 174, 154};
inline constexpr Rgb kLawn{104, 132, 72};
inline constexpr Rgb kMetal{150, 152, 156};
inline constexpr Rgb kSoil{168, 136, 98};
inline constexpr Rgb kWaterBlue{62, 98, 116};

}  // namespace culprit::sunset
