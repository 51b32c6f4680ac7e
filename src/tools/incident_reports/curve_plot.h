// Curves of a recording as pictures (SVG), one below the other on the same time axis: seconds since the incident was
// detected. culprit's findings and actions are marked in each.
#pragma once

#include <string>
#include <vector>

#include "incident_reports/recorded_curves.h"

namespace culprit::incident_reports {

struct Mark {
  enum class Kind : std::uint8_t { kDetected, kDecided, kNoHelp, kResolved, kGivenUp };
  Kind kind = Kind::kDetected;
  double at = 0;  // seconds since 1970
  std::string text;
};

// "◆", "▼", "✕", "✓", "✖"
std::string_view sign_of(Mark::Kind kind);

struct PlotFrame {
  double begin = 0;  // seconds since 1970
  double end = 0;
  double zero = 0;  // what times are counted from
  std::vector<Mark> marks;
};

// A <figure>. `number` distinguishes it from others in the same document. Colours are those of the document's style: the classes "curve", "limit", "mark", and
// of marks "detected", "decided", "no-help", "resolved", "given-up".
std::string plot_of(const Curve& curve, const PlotFrame& frame, std::size_t number);

}  // namespace culprit::incident_reports
