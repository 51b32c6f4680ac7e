// Values that the rules read in the past: the journal's observations once more through the manager, and a look each second.
#pragma once

#include <string>
#include <vector>

#include "base/expected.h"
#include "journal/reader.h"

namespace culprit::replay {

struct Curves {
  std::vector<double> clocks;               // seconds since 1970, the oldest first
  std::vector<std::vector<float>> columns;  // by name, one value a clock; NaN: unknown
};

struct CurveWish {
  std::vector<std::string> names;  // of plotted_names(); one that no run has is never known
  std::int64_t since = 0;          // nanoseconds since 1970
  std::int64_t until = 0;
  std::size_t most = 2000;  // clocks: of longer times the least and the greatest values are kept
};

// Over all runs of that time, each by its own rules. Processor and memory are there where rules read them. Errors: the
// journal has no run of that time, or is unreadable.
Expected<Curves> curves_of(const journal::Reader& journal, const CurveWish& wish);

// Since when there are curves, nanoseconds since 1970; nothing: the journal has no run. Errors: it is unreadable.
Expected<std::optional<std::int64_t>> oldest_curve(const journal::Reader& journal);

}  // namespace culprit::replay
