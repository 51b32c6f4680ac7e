#include "exemplars/sunset/town.h"

#include <cstddef>

#include "exemplars/sunset/block.h"
#include "exemplars/sunset/brush.h"
#include "exemplars/sunset/daylight.h"
#include "exemplars/sunset/traffic.h"
#include "simulation/random.h"

namespace culprit::sunset {
namespace {

constexpr int kRoadsPerAxis = 6;
constexpr double kSidewalk = 2.0;         // metres
constexpr double kSidewalkHeight = 0.15;  // metres
constexpr double kKerbParking = 2.2;      // metres, the width of a parked row

std::vector<Road> plan_roads(simulation::Random& random) {
  std::vector<Road> roads;
  for (const Axis axis : {Axis::kX, Axis::kY}) {
    const int avenue = random.below(kRoadsPerAxis);
    for (int i = 0; i < kRoadsPerAxis; ++i) {
      Road road;
      road.axis = axis;
      road.centre = (i + 0.5 + random.uniform(-0.12, 0.12)) * kTerrainMetres / kRoadsPerAxis;
      road.lanes = i == avenue ? 2 : 1;
      road.kerb_parking = i != avenue;
      road.half_width = road.lanes * kLaneMetres + (road.kerb_parking ? kKerbParking : 0.4);
      roads.push_back(road);
    }
  }
  return roads;
}

// The cells of `road` between two distances from its centre line, over the whole length or a part
// of it. A negative distance is on the side of smaller coordinates.
Rect strip(const Road& road, double from, double to, int begin = 0, int length = kTerrainCells) {
  const int near = cells(road.centre + from);
  const int width = cells(road.centre + to) - near;
  return road.axis == Axis::kX ? Rect{begin, near, length, width}
                               : Rect{near, begin, width, length};
}

// Near a crossing there are no lines, parked cars or trees. `cell` counts along a road of `axis`.
bool on_crossing(const std::vector<Road>& roads, Axis axis, int cell) {
  const double along = (cell + 0.5) * kCellMetres;
  for (const Road& other : roads) {
    if (other.axis == axis) continue;
    const double clear = other.half_width + 3.4;
    if (along > other.centre - clear && along < other.centre + clear) return true;
  }
  return false;
}

// Lane lines, dashed but for the centre line of an avenue, and zebra crossings at the junctions.
void mark(Terrain& terrain, const std::vector<Road>& roads, const Road& road) {
  const Surface line{Label::kRoad, kMarking, 0};
  for (int cell = 0; cell < kTerrainCells; ++cell) {
    if (on_crossing(roads, road.axis, cell)) continue;
    const bool dash = cell % 20 < 9;
    if (road.lanes > 1 || dash) paint(terrain, strip(road, -0.2, 0.2, cell, 1), line);
    for (int lane = 1; lane < road.lanes && dash; ++lane) {
      const double offset = lane * kLaneMetres;
      paint(terrain, strip(road, offset - 0.2, offset + 0.2, cell, 1), line);
      paint(terrain, strip(road, -offset - 0.2, -offset + 0.2, cell, 1), line);
    }
  }
  for (const Road& other : roads) {
    if (other.axis == road.axis) continue;
    for (const double side : {-1.0, 1.0}) {
      const int begin = cells(other.centre + side * (other.half_width + 2.0) - 1.4);
      for (double offset = -road.half_width + 0.6; offset < road.half_width - 0.6; offset += 1.6) {
        paint(terrain, strip(road, offset, offset + 0.8, begin, cells(2.8)), line);
      }
    }
  }
}

void park_along(const std::vector<Road>& roads, const Road& road, simulation::Random& random,
                std::vector<Vehicle>& parked) {
  for (const double side : {-1.0, 1.0}) {
    for (double along = 0; along < kTerrainMetres; along += 6.5) {
      Vehicle car = random_vehicle(random);
      const bool there = random.chance(0.3);
      if (!there || on_crossing(roads, road.axis, cells(along))) continue;
      const double across = road.centre + side * (road.half_width - 0.5 * kKerbParking);
      const bool x_axis = road.axis == Axis::kX;
      car.centre = x_axis ? Point{along, across} : Point{across, along};
      car.front = x_axis ? Point{side, 0} : Point{0, -side};
      parked.push_back(car);
    }
  }
}

void plant_along(Terrain& terrain, const std::vector<Road>& roads, const Road& road,
                 simulation::Random& random) {
  for (const double side : {-1.0, 1.0}) {
    const int across = cells(road.centre + side * (road.half_width + kSidewalk + 1.0));
    for (int along = 0; along < kTerrainCells; along += cells(12)) {
      if (!random.chance(0.4) || on_crossing(roads, road.axis, along)) continue;
      const bool x_axis = road.axis == Axis::kX;
      const int x = x_axis ? along : across;
      const int y = x_axis ? across : along;
      if (terrain.at(x, y).label != Label::kGrass) continue;
      paint_tree(terrain, x, y, random.uniform(4.0, 6.5), random);
    }
  }
}

struct Span {
  double begin = 0;  // metres
  double end = 0;
};

// The area between the sidewalks of two neighbouring roads. The last block of an axis lies across
// the torus' seam.
Span between(const Road& road, const Road& next) {
  const double seam = next.centre > road.centre ? 0 : kTerrainMetres;
  return {road.centre + road.half_width + kSidewalk,
          next.centre + seam - next.half_width - kSidewalk};
}

// Water along the left edge of a block, with a quay towards the block.
void paint_canal(Terrain& terrain, const Rect& canal) {
  paint(terrain, canal, {Label::kWater, kWaterBlue, 0});
  const int quay = cells(1.2);
  paint(terrain, {canal.x + canal.width - quay, canal.y, quay, canal.height},
        {Label::kPavement, kConcrete, kSidewalkHeight});
}

void paint_blocks(Town& town, simulation::Random& random) {
  std::vector<Road> rows;
  std::vector<Road> columns;
  for (const Road& road : town.roads) (road.axis == Axis::kX ? rows : columns).push_back(road);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Span across = between(columns[i], columns[(i + 1) % columns.size()]);
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const Span down = between(rows[j], rows[(j + 1) % rows.size()]);
      Rect area{cells(across.begin), cells(down.begin), cells(across.end) - cells(across.begin),
                cells(down.end) - cells(down.begin)};
      if (i == 0) {
        const int canal = cells(14);
        paint_canal(town.terrain, {area.x, area.y, canal, area.height});
        area.x += canal;
        area.width -= canal;
      }
      paint_block(town.terrain, area, random, town.parked);
    }
  }
}

}  // namespace

Town build_town(std::uint64_t seed) {
  simulation::Random random(seed);
  Town town;
  town.roads = plan_roads(random);
  const Surface sidewalk{Label::kPavement, kConcrete, kSidewalkHeight};
  for (const Road& road : town.roads) {
    const double edge = road.half_width + kSidewalk;
    paint(town.terrain, strip(road, -edge, edge), sidewalk);
  }
  for (const Road& road : town.roads) {
    const double edge = road.half_width;
    paint(town.terrain, strip(road, -edge, edge), {Label::kRoad, kAsphalt, 0});
  }
  for (const Road& road : town.roads) {
    mark(town.terrain, town.roads, road);
    if (road.kerb_parking) park_along(town.roads, road, random, town.parked);
  }
  // After the roads, so that crowns may reach over them.
  paint_blocks(town, random);
  for (const Road& road : town.roads) plant_along(town.terrain, town.roads, road, random);
  light(town.terrain, random.next());
  return town;
}

}  // namespace culprit::sunset
