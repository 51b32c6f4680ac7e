#include "suave_study/published.h"

#include <algorithm>
#include <array>

namespace culprit::study::published {
namespace {

Moments of(double mean, double sd) { return Moments::of_summary(mean, sd, kSuaveRuns); }

// Under the names of the table's head, in its order.
SuaveResult ours(std::string_view mission, Moments search, Moments distance, double u1, double u2,
                 std::optional<double> u3 = {}) {
  return {mission, "culprit", search, distance, u1, u2, u3};
}

SuaveResult copied(std::string_view mission, std::string_view manager, Moments search,
                   Moments distance, double u1, double u2, std::optional<double> u3 = {}) {
  return {mission, manager, search, distance, u2, u1, u3};
}

std::array<SuaveResult, 8> table() {
  return {{
      {"standard", "none", of(174.75, 36.00), of(33.20, 13.49), {}, {}, {}},
      copied("standard", "bt", of(84.09, 26.41), of(62.70, 7.78), 0.08, 0.10),
      copied("standard", "metacontrol", of(89.24, 35.57), of(60.57, 11.17), 1.55, 0.82),
      copied("standard", "rosa", of(85.11, 32.48), of(60.76, 10.29), 1.24, 1.57),
      ours("standard", of(81.52, 19.01), of(62.69, 6.06), 0.30, 0.25),
      copied("extended", "bt", of(94.37, 34.92), of(20.88, 3.81), 0.07, 0.10, 1.09),
      copied("extended", "rosa", of(92.75, 35.92), of(18.97, 3.38), 1.39, 1.67, 2.50),
      ours("extended", of(82.78, 20.68), of(21.60, 6.85), 0.36, 0.34, 1.31),
  }};
}

}  // namespace

std::span<const SuaveResult> suave() {
  static const std::array kTable = table();
  return kTable;
}

const SuaveResult* find_suave(std::string_view mission, std::string_view manager) {
  const auto found = std::find_if(suave().begin(), suave().end(), [&](const SuaveResult& row) {
    return row.mission == mission && row.manager == manager;
  });
  return found == suave().end() ? nullptr : &*found;
}

}  // namespace culprit::study::published
