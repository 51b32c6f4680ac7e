// How far the inputs of triggers vary while the robot is well, by the journal of a run, and which thresholds follow.
//
// A trigger's comparison with a number is measured if its other side is age(topic), rate(topic) or a signal. Time during
// a fault, and until the robot was well again, counts as faulty.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "journal/reader.h"
#include "language/syntax.h"
#include "replay/recording.h"

namespace culprit::drill {

// One comparison in a trigger, as it is written in the file.
struct Comparison {
  enum class What : std::uint8_t { kAge, kRate, kSignal };
  std::string rule;
  What what = What::kAge;
  std::string subject;   // topic or signal
  bool is_above = true;  // the trigger is true beyond the threshold, not below it
  double threshold = 0;  // seconds, Hz, or as the signal
  bool is_duration = false;
  std::string constant{};  // that holds it; empty: a number
  Span span{};             // of the number, there or in the CONST line
};
std::vector<Comparison> comparisons_in(const syntax::File& file);

struct ThresholdMeasure {
  Comparison of;
  std::size_t values = 0;  // while the robot was well
  double least = 0;        // seconds, Hz, or as the signal
  double most = 0;
  double longest_beyond = 0;  // seconds that a healthy value was beyond the file's threshold
  std::optional<double>
      faulty{};       // the mildest of the extremes of the faults that tripped the rule
  double looked = 0;  // seconds

  // Beyond all healthy values; between them and the faulty ones if those are known. Nothing: too few values, they never
  // change, or no number separates them.
  std::optional<double> proposed() const;
  // Whether the file's threshold is beyond all healthy values, short of the faulty ones, and for a silence neither close to
  // a healthy pause nor much longer than proposed. There is nothing to gain by another one.
  bool is_proven() const;
  // With 95 % certainty a healthy robot is beyond the largest healthy value at most so often in an hour.
  double most_an_hour() const;
};

// The measures of two runs of the same rules, as if they were one run.
void add(ThresholdMeasure& sum, const ThresholdMeasure& more);

// `at_start`: seconds since 1970 when the recorded run began. `faulty`: when a fault was injected, until well; `tripped`
// says which rules fired in it. Errors: the journal cannot be read.
struct FaultyStretch {
  double from = 0;
  double until = 0;
  std::vector<std::string> rules;
};
Expected<std::vector<ThresholdMeasure>> measure(replay::Recording& recording, double at_start,
                                                const std::vector<Comparison>& comparisons,
                                                const std::vector<FaultyStretch>& faulty);
// The measures of all runs in a journal of one rule file: a drill that was resumed has several. Errors: it has none, or cannot be read.
Expected<std::vector<ThresholdMeasure>> measure_all(const journal::Reader& journal,
                                                    const std::vector<Comparison>& comparisons,
                                                    const std::vector<FaultyStretch>& faulty);

}  // namespace culprit::drill
