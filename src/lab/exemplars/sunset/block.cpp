#include "exemplars/sunset/block.h"

#include <algorithm>
#include <array>

#include "exemplars/sunset/traffic.h"

namespace culprit::sunset {
namespace {

// Draws from `random` are never two arguments of one call: compilers differ in which they evaluate
// first.

constexpr std::array kTiles = {Rgb{172, 94, 70}, Rgb{150, 80, 64}, Rgb{134, 104, 86},
                               Rgb{122, 122, 132}};
constexpr std::array kFlatRoofs = {Rgb{190, 188, 184}, Rgb{208, 206, 202}, Rgb{156, 154, 156},
                                   Rgb{176, 160, 148}};
constexpr Rgb kLot{160, 146, 126};
constexpr Rgb kHedge{72, 100, 56};
constexpr Rgb kDryLawn{124, 134, 82};
constexpr Rgb kBareConcrete{176, 172, 166};

template <typename Choices>
Rgb any_of(const Choices& choices, simulation::Random& random) {
  return choices[static_cast<std::size_t>(random.below(static_cast<int>(choices.size())))];
}

void scatter_trees(Terrain& terrain, Rect area, int count, simulation::Random& random) {
  for (int i = 0; i < count; ++i) {
    const int x = area.x + random.below(std::max(1, area.width));
    const int y = area.y + random.below(std::max(1, area.height));
    if (terrain.at(x, y).label == Label::kGrass || terrain.at(x, y).label == Label::kTree) {
      paint_tree(terrain, x, y, random.uniform(4.0, 9.5), random);
    }
  }
}

// Lots of about 15 m x 20 m, each with a house, a drive and a garden.
void paint_houses(Terrain& terrain, Rect area, simulation::Random& random) {
  paint(terrain, area, {Label::kTree, kHedge, 1.3});  // what the lots leave of it are hedges
  const int columns = std::max(1, area.width / cells(15));
  const int rows = std::max(1, area.height / cells(20));
  const int lot_width = area.width / columns;
  const int lot_height = area.height / rows;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Rect lot{area.x + column * lot_width, area.y + row * lot_height, lot_width, lot_height};
      const Rgb garden = random.chance(0.3) ? kDryLawn : kLawn;
      paint(terrain, lot.inset(1), {Label::kGrass, garden, 0});
      const int width = std::min(cells(random.uniform(8, 11)), lot_width - 8);
      const int height = std::min(cells(random.uniform(8, 13)), lot_height - 8);
      const Rect house{lot.x + 3 + random.below(std::max(1, lot_width - width - 6)),
                       lot.y + 3 + random.below(std::max(1, lot_height - height - 6)), width,
                       height};
      const Rect drive{house.x + 2, lot.y, cells(2.8), house.y - lot.y};
      paint(terrain, drive, {Label::kPavement, kConcrete, 0});
      scatter_trees(terrain, lot.inset(2), 2 + random.below(3), random);
      const double eaves = random.uniform(3.0, 5.5);
      paint_gabled_house(terrain, house, eaves, any_of(kTiles, random));
    }
  }
}

// Two buildings in a row that share `area`, with a gap between them.
void paint_pair(Terrain& terrain, Rect area, double low, double high, simulation::Random& random) {
  const int gap = cells(6);
  const int split = area.width * (35 + random.below(30)) / 100;
  const Rgb roof = any_of(kFlatRoofs, random);
  const Rect left{area.x, area.y, split - gap / 2, area.height};
  const Rect right{area.x + split + gap / 2, area.y, area.width - split - gap / 2, area.height};
  for (const Rect& building : {left, right}) {
    paint_flat_building(terrain, building, random.uniform(low, high), roof, random);
  }
}

// Two rows of buildings with a green yard between them.
void paint_apartments(Terrain& terrain, Rect area, simulation::Random& random) {
  paint(terrain, area, {Label::kGrass, kLawn, 0});
  const int depth = cells(12);
  const Rect yard{area.x, area.y + depth + 8, area.width, area.height - 2 * (depth + 8)};
  const Rect path{yard.x, yard.y + yard.height / 2, yard.width, cells(2)};
  paint(terrain, path, {Label::kGround, kSoil, 0});
  scatter_trees(terrain, yard, 26, random);
  for (const int y : {area.y + 4, area.y + area.height - depth - 4}) {
    paint_pair(terrain, {area.x + 4, y, area.width - 8, depth}, 6, 10, random);
  }
}

// Cars in rows of places, each row with its lane; many places are free.
void park_rows(Rect lot, simulation::Random& random, std::vector<Vehicle>& parked) {
  const int rows = lot.height / cells(8);
  const int places = (lot.width - 4) / cells(2.7);
  for (int row = 0; row < rows; ++row) {
    for (int place = 0; place < places; ++place) {
      Vehicle car = random_vehicle(random);
      if (!random.chance(0.45)) continue;
      car.centre = {(lot.x + 2) * kCellMetres + (place + 0.5) * 2.7,
                    lot.y * kCellMetres + row * 8.0 + 4.0};
      car.front = {0, random.chance(0.5) ? 1.0 : -1.0};
      parked.push_back(car);
    }
  }
}

// Two halls and their parking lot.
void paint_commerce(Terrain& terrain, Rect area, simulation::Random& random,
                    std::vector<Vehicle>& parked) {
  paint(terrain, area, {Label::kPavement, kLot, 0});
  const int split = area.height * 11 / 20;
  paint_pair(terrain, {area.x + 4, area.y + 4, area.width - 8, split - 8}, 5, 8, random);
  const Rect lot{area.x + 4, area.y + split, area.width - 8, area.height - split - 4};
  park_rows(lot, random, parked);
  const Rect verge{area.x, area.y + area.height - 5, area.width, 5};
  paint(terrain, verge, {Label::kGrass, kLawn, 0});
  scatter_trees(terrain, verge, 5, random);
}

// Two paths that cross, a pond, trees.
void paint_park(Terrain& terrain, Rect area, simulation::Random& random) {
  paint(terrain, area, {Label::kGrass, kLawn, 0});
  const Rect along{area.x, area.y + area.height / 2, area.width, cells(2.4)};
  const Rect across{area.x + area.width / 3, area.y, cells(2.4), area.height};
  paint(terrain, along, {Label::kGround, kSoil, 0});
  paint(terrain, across, {Label::kGround, kSoil, 0});
  const Rect pond{area.x + area.width * 2 / 5, area.y + 6, area.width / 2, area.height / 2 - 10};
  paint_pond(terrain, pond);
  scatter_trees(terrain, area, 34, random);
}

// Bare soil, a shell of a building, containers.
void paint_building_site(Terrain& terrain, Rect area, simulation::Random& random) {
  paint(terrain, area, {Label::kGround, kSoil, 0});
  const int containers = 12;
  for (int i = 0; i < containers; ++i) {
    const bool across = random.chance(0.5);
    const Rect container{area.x + random.below(area.width - cells(6)),
                         area.y + random.below(area.height - cells(6)), cells(across ? 2.5 : 6.0),
                         cells(across ? 6.0 : 2.5)};
    paint(terrain, container, {Label::kBuilding, any_of(kTiles, random), 2.6});
  }
  const Rect shell{area.x + area.width / 4, area.y + area.height / 4, area.width * 2 / 5,
                   area.height / 3};
  paint_flat_building(terrain, shell, random.uniform(4, 9), kBareConcrete, random);
  const Rect strip{area.x, area.y + area.height - cells(7), area.width, cells(7)};
  paint(terrain, strip, {Label::kGrass, kDryLawn, 0});
  scatter_trees(terrain, strip, 8, random);
}

}  // namespace

void paint_block(Terrain& terrain, Rect area, simulation::Random& random,
                 std::vector<Vehicle>& parked) {
  const double kind = random.uniform();
  if (kind < 0.40) {
    paint_houses(terrain, area, random);
  } else if (kind < 0.58) {
    paint_apartments(terrain, area, random);
  } else if (kind < 0.74) {
    paint_commerce(terrain, area, random, parked);
  } else if (kind < 0.90) {
    paint_park(terrain, area, random);
  } else {
    paint_building_site(terrain, area, random);
  }
}

}  // namespace culprit::sunset
