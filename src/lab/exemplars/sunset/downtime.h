// How long an output was missing.
//
// The exemplar adds up all gaps between two outputs that are longer than two frame periods, each in
// full. A robot that never recovers has no downtime then: what is before the first
// output and after the last one does not count. So both figures are given.
#pragma once

#include <optional>

#include "base/time.h"

namespace culprit::sunset {

class Downtime {
 public:
  // A gap is downtime if it is longer than `tolerated`.
  Downtime(Time begin, Duration tolerated) : begin_(begin), tolerated_(tolerated) {}

  // Times do not decrease.
  void on_output(Time at);

  // The exemplar's figure.
  Duration between_outputs() const { return between_; }

  // Also with the gaps at the begin and at the end; the latter is open until the next output.
  Duration total(Time now) const;

 private:
  Duration counted(Duration gap) const { return gap > tolerated_ ? gap : Duration::zero(); }

  Time begin_;
  Duration tolerated_;
  std::optional<Time> first_;
  Time last_{};
  Duration between_{};
};

}  // namespace culprit::sunset
