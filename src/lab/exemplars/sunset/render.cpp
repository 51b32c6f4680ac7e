#include "exemplars/sunset/render.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "exemplars/sunset/daylight.h"

namespace culprit::sunset {
namespace {

// The march along a ray, in whole height units: from above everything down to the ground. Steps are
// short enough that no ray of the camera's jumps over a hedge.
constexpr int kMarchTop = 15 * kHeightUnitsPerMetre;
constexpr int kMarchStep = kHeightUnitsPerMetre / 2;

// Cells with 16 binary fractions. Wrapping at 32 bits is harmless: the terrain's period divides it.
std::uint32_t fixed_cells(double metres) {
  return static_cast<std::uint32_t>(
      static_cast<std::int64_t>(std::floor(metres / kCellMetres * 65536.0)));
}

// The first thing that a ray meets on its way down.
struct Hit {
  const Cell* cell = nullptr;
  int height = 0;  // in height units; below the cell's own where the ray meets a wall
  bool wall = false;
};

Hit march(const Terrain& terrain, const Camera& camera, Point slope) {
  const double descent = kAltitudeMetres - height_metres(kMarchTop);
  std::uint32_t x = fixed_cells(camera.position().x + slope.x * descent);
  std::uint32_t y = fixed_cells(camera.position().y + slope.y * descent);
  const std::uint32_t step_x = fixed_cells(slope.x * height_metres(kMarchStep));
  const std::uint32_t step_y = fixed_cells(slope.y * height_metres(kMarchStep));
  for (int height = kMarchTop;; height -= kMarchStep) {
    const Cell& cell = terrain.at(static_cast<int>(x >> 16U), static_cast<int>(y >> 16U));
    if (cell.height >= height + kMarchStep) return {&cell, height + kMarchStep / 2, true};
    if (cell.height >= height || height == 0) return {&cell, cell.height, false};
    x += step_x;
    y += step_y;
  }
}

Rgb facade(Rgb roof) {
  const auto darker = [](std::uint8_t channel) {
    return static_cast<std::uint8_t>(channel * 3 / 4);
  };
  return {darker(roof.r), darker(roof.g), darker(roof.b)};
}

// The shortest way around the torus.
double torus_offset(double from, double to) {
  const double offset = to - from;
  return offset - kTerrainMetres * std::floor(offset / kTerrainMetres + 0.5);
}

// A horizontal rectangle of a vehicle, around its centre.
struct Layer {
  double height = 0;
  double length = 0;
  double width = 0;
};

// Calls draw(index) for each pixel whose ray meets `layer`, laid out like `vehicle` at `offset`
// from the camera, before anything that is drawn so far.
template <typename Draw>
void for_each_pixel(const View& view, const Camera& camera, Point offset, const Vehicle& vehicle,
                    const Layer& layer, Draw draw) {
  const Size size = view.height.size;
  const double descent = kAltitudeMetres - layer.height;
  const Point middle = camera.project(offset, layer.height);
  const double reach =
      0.5 * (layer.length + layer.width) * camera.pixels_per_metre(layer.height) + 1.0;
  const int left = std::max(0, static_cast<int>(middle.x - reach));
  const int right = std::min(size.width - 1, static_cast<int>(middle.x + reach));
  const int top = std::max(0, static_cast<int>(middle.y - reach));
  const int bottom = std::min(size.height - 1, static_cast<int>(middle.y + reach));
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      const Point slope = camera.slope(column, row);
      const double dx = slope.x * descent - offset.x;
      const double dy = slope.y * descent - offset.y;
      const double along = dx * vehicle.front.x + dy * vehicle.front.y;
      const double across = dx * vehicle.front.y - dy * vehicle.front.x;
      const std::size_t i = view.height.index(column, row);
      const bool hidden = view.height.pixels[i] > layer.height + 0.3;
      if (hidden || std::abs(along) > 0.5 * layer.length || std::abs(across) > 0.5 * layer.width) {
        continue;
      }
      draw(i);
    }
  }
}

}  // namespace

View render_terrain(const Terrain& terrain, const Camera& camera, Size size) {
  View view{RgbImage(size), LabelImage(size), Image<float>(size)};
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      const Hit hit = march(terrain, camera, camera.slope(column, row));
      const std::size_t i = view.rgb.index(column, row);
      const bool is_facade = hit.wall && hit.cell->label == Label::kBuilding;
      view.rgb.pixels[i] = is_facade ? facade(hit.cell->colour) : hit.cell->colour;
      view.truth.pixels[i] = hit.cell->label;
      view.height.pixels[i] = static_cast<float>(height_metres(hit.height));
    }
  }
  return view;
}

void render_vehicle(View& view, const Terrain& terrain, const Camera& camera,
                    const Vehicle& vehicle) {
  const Point offset{torus_offset(camera.position().x, vehicle.centre.x),
                     torus_offset(camera.position().y, vehicle.centre.y)};
  constexpr double kOutOfSight = 60.0;  // metres: half a frame's diagonal, and a truck
  if (std::hypot(offset.x, offset.y) > kOutOfSight) return;

  const bool sunlit = terrain
                          .at(static_cast<int>(std::floor(vehicle.centre.x / kCellMetres)),
                              static_cast<int>(std::floor(vehicle.centre.y / kCellMetres)))
                          .sunlit;
  if (sunlit) {
    const double cast = 0.35 * vehicle.height;
    for_each_pixel(view, camera, {offset.x + cast, offset.y + cast}, vehicle,
                   {0, vehicle.length, vehicle.width},
                   [&](std::size_t i) { view.rgb.pixels[i] = in_shadow(view.rgb.pixels[i]); });
  }
  const auto draw = [&](const Layer& layer, Rgb colour) {
    for_each_pixel(view, camera, offset, vehicle, layer, [&](std::size_t i) {
      view.rgb.pixels[i] = sunlit ? colour : in_shadow(colour);
      view.truth.pixels[i] = Label::kVehicle;
      view.height.pixels[i] = static_cast<float>(layer.height);
    });
  };
  constexpr Rgb kGlass{66, 76, 88};
  draw({0.65 * vehicle.height, vehicle.length, vehicle.width}, vehicle.colour);
  draw({0.9 * vehicle.height, 0.62 * vehicle.length, 0.86 * vehicle.width}, kGlass);
  draw({vehicle.height, 0.36 * vehicle.length, 0.8 * vehicle.width}, vehicle.colour);
}

}  // namespace culprit::sunset
