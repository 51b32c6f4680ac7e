// Do the monitors keep the lateness that the rule file states (knowledge/latencies.h)? The way in
// which failures spread along the graph shows it.
//
// A failure takes about half a second to pass an edge. So if j fails, and its monitor and that of a
// direct consumer i are late by at most m, the detections of i and j are apart by
//
//     d_i - d_j ~ Normal(0.5 s, (0.4 s)^2 + m^2 / 6)
//
// This compares m as stated with that of slow monitors, for each pair: of two that failed, by the
// densities (or they failed for unrelated reasons); while i is quiet, by the probabilities that it is
// quiet still. Only detections count that no repair of culprit can have touched.
//
//     LatenessWatch lateness(knowledge, latencies);
//     lateness.advance(now);                       // once a step
//     if (latencies.statement() == Latencies::Statement::kExceeded) ...
#pragma once

#include "knowledge/knowledge.h"

namespace culprit {

class LatenessWatch {
 public:
  // Both must outlive it. `latencies` is that of `knowledge`, which it judges.
  LatenessWatch(const Knowledge& knowledge, Latencies& latencies);

  void advance(Time now);

 private:
  // Was it detected just now, and did culprit do nothing about it yet?
  bool is_fresh(RuleId failure, Time now) const;
  double weight(RuleId cause, RuleId effect, Time now) const;

  const Knowledge& knowledge_;
  Latencies& latencies_;
};

}  // namespace culprit
