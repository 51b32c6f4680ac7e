// The map that the drone flies over: a torus of square cells, each with what it is, how high it
// stands and how it looks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "exemplars/sunset/image.h"

namespace culprit::sunset {

inline constexpr int kTerrainCells = 1024;  // a power of two: wrapping is a mask
inline constexpr double kCellMetres = 0.4;
inline constexpr double kTerrainMetres = kTerrainCells * kCellMetres;

// To the nearest whole cell; for lengths and places that are not negative.
constexpr int cells(double metres) { return static_cast<int>(metres / kCellMetres + 0.5); }

// Heights are counted in sixteenths of a metre; a cell's lies below 16 m.
inline constexpr int kHeightUnitsPerMetre = 16;
constexpr double height_metres(int units) {
  return static_cast<double>(units) / kHeightUnitsPerMetre;
}
constexpr std::uint8_t height_units(double metres) {
  return static_cast<std::uint8_t>(std::clamp(metres * kHeightUnitsPerMetre + 0.5, 0.0, 255.0));
}

struct Cell {
  Rgb colour;
  Label label = Label::kGrass;
  std::uint8_t height = 0;  // in height units
  bool sunlit = true;
};

class Terrain {
 public:
  Terrain() : cells_(std::size_t{kTerrainCells} * kTerrainCells) {}

  // Any x and y: the map repeats every kTerrainCells.
  Cell& at(int x, int y) { return cells_[index(x, y)]; }
  const Cell& at(int x, int y) const { return cells_[index(x, y)]; }

 private:
  static std::size_t index(int x, int y) {
    constexpr unsigned kMask = kTerrainCells - 1;
    return std::size_t{static_cast<unsigned>(y) & kMask} * kTerrainCells +
           (static_cast<unsigned>(x) & kMask);
  }

  std::vector<Cell> cells_;
};

}  // namespace culprit::sunset
