#include "exemplars/sunset/brush.h"

#include <cmath>
#include <cstdlib>

namespace culprit::sunset {
namespace {

void put(Terrain& terrain, int x, int y, const Surface& surface) {
  Cell& cell = terrain.at(x, y);
  cell.label = surface.label;
  cell.colour = surface.colour;
  cell.height = height_units(surface.height);
}

}  // namespace

void paint(Terrain& terrain, Rect area, const Surface& surface) {
  for (int y = area.y; y < area.y + area.height; ++y) {
    for (int x = area.x; x < area.x + area.width; ++x) put(terrain, x, y, surface);
  }
}

void paint_gabled_house(Terrain& terrain, Rect area, double eaves, Rgb roof) {
  const bool ridge_along_x = area.width >= area.height;
  const double half_span = 0.5 * (ridge_along_x ? area.height : area.width);
  const double rise = 0.55 * kCellMetres;  // for each cell inwards: 29 degrees
  for (int y = 0; y < area.height; ++y) {
    for (int x = 0; x < area.width; ++x) {
      const double across = ridge_along_x ? y + 0.5 : x + 0.5;
      const double inwards = half_span - std::abs(across - half_span);
      put(terrain, area.x + x, area.y + y, {Label::kBuilding, roof, eaves + rise * inwards});
    }
  }
}

void paint_flat_building(Terrain& terrain, Rect area, double height, Rgb roof,
                         simulation::Random& random) {
  const Rgb rim{static_cast<std::uint8_t>(roof.r - 20), static_cast<std::uint8_t>(roof.g - 20),
                static_cast<std::uint8_t>(roof.b - 20)};
  paint(terrain, area, {Label::kBuilding, rim, height});
  const Rect top = area.inset(1);
  paint(terrain, top, {Label::kBuilding, roof, height});
  const int boxes = 1 + random.below(4);
  for (int i = 0; i < boxes; ++i) {
    const int size = 4 + random.below(5);
    if (top.width <= size || top.height <= size) continue;
    const Rect box{top.x + random.below(top.width - size), top.y + random.below(top.height - size),
                   size, size};
    paint(terrain, box, {Label::kBuilding, kMetal, height + 1.5});
  }
}

void paint_tree(Terrain& terrain, int x, int y, double height, simulation::Random& random) {
  const double radius = cells(0.42 * height);
  const int reach = static_cast<int>(radius) + 1;
  const int tone = random.below(24);
  const Rgb leaves{static_cast<std::uint8_t>(62 + tone), static_cast<std::uint8_t>(94 + tone / 2),
                   static_cast<std::uint8_t>(48 + tone / 2)};
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const double distance = (dx * dx + dy * dy) / (radius * radius);
      if (distance > random.uniform(0.75, 1.1)) continue;
      const double crown = height * (1.0 - 0.55 * distance) + random.uniform(-0.5, 0.3);
      if (height_units(crown) <= terrain.at(x + dx, y + dy).height) continue;
      put(terrain, x + dx, y + dy, {Label::kTree, leaves, crown});
    }
  }
}

void paint_pond(Terrain& terrain, Rect area) {
  for (int y = 0; y < area.height; ++y) {
    for (int x = 0; x < area.width; ++x) {
      const double u = 2.0 * (x + 0.5) / area.width - 1.0;
      const double v = 2.0 * (y + 0.5) / area.height - 1.0;
      const double distance = u * u + v * v;
      if (distance > 1.0) continue;
      put(terrain, area.x + x, area.y + y,
          distance > 0.8 ? Surface{Label::kGround, kSoil, 0}
                         : Surface{Label::kWater, kWaterBlue, 0});
    }
  }
}

}  // namespace culprit::sunset
