// How far one sees in the water, and how high above the seabed that lets a vehicle search.
#pragma once

#include <array>
#include <cstdint>

namespace culprit::suave::model {

// Metres, `second` whole seconds after the mission began: a cosine between `least` and `most` with
// a period of `period_s`, which was at its most `shift_s` before.
double water_visibility(std::int64_t second, double period_s = 80, double shift_s = 0,
                        double least = 1.25, double most = 3.75);

// The modes of the search, best first.
struct SearchMode {
  const char* name;
  double altitude;    // above the seabed
  double visibility;  // that it needs at least
};
inline constexpr std::array<SearchMode, 3> kSearchModes = {
    {{"fd_spiral_high", 3, 3.25}, {"fd_spiral_medium", 2, 2.25}, {"fd_spiral_low", 1, 1.25}}};

}  // namespace culprit::suave::model
