// The beliefs about strategies and failures, by name, so that they outlive the rule file's numbers.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "knowledge/beliefs.h"
#include "knowledge/coincidences.h"
#include "knowledge/couplings.h"
#include "knowledge/latencies.h"
#include "knowledge/transients.h"

namespace culprit::journal {

struct LearnedBelief {
  std::string rule;
  std::string strategy;
  Belief belief;
  Belief prior;  // the designer's or the fleet's, that `belief` grew from
  bool operator==(const LearnedBelief&) const = default;
};

struct LearnedCoupling {
  std::string cause;
  std::string effect;
  Coupling coupling;
  bool operator==(const LearnedCoupling&) const = default;
};

// Times that were learned of a rule: how late it is; or, under a name that no rule has, the failures
// that cleared by themselves, or did not. Seconds, because people read it.
struct LearnedLatency {
  std::string rule;
  int count = 0;  // 0: nothing is known any more
  double least_s = 0;
  double most_s = 0;
  bool operator==(const LearnedLatency&) const = default;
};
LearnedLatency named(const std::string& rule, const Latencies::Learned& learned);
Latencies::Learned latency_from(const LearnedLatency& learned);
std::array<LearnedLatency, 2> named(const std::string& rule, const Transients::Seen& seen);
// The rule, and one part of what is known of it; nothing: it is the lateness of a rule.
std::optional<std::pair<std::string, Transients::Seen>> transients_from(
    const LearnedLatency& learned);

// How often the failures of two rules began together; of a rule with itself: how often it began.
struct LearnedCoincidence {
  std::string rule;  // not after `other` in the alphabet
  std::string other;
  int count = 0;  // 0: nothing is known any more
  bool operator==(const LearnedCoincidence&) const = default;
};
LearnedCoincidence coincidence_of(std::string one, std::string other, int count);
// The counts that differ from `before`, which is of the same rules.
std::vector<LearnedCoincidence> named(const Coincidences& coincidences, const Coincidences& before,
                                      const RuleSet& rules);

struct Learned {
  std::vector<LearnedBelief> beliefs{};
  std::vector<LearnedCoupling> couplings{};
  std::vector<LearnedLatency> latencies{};
  // They change with each detection. So they make no rows, and nobody waits until they are on the disk.
  std::vector<LearnedCoincidence> coincidences{};

  bool has_outcomes() const { return !beliefs.empty() || !couplings.empty() || !latencies.empty(); }
  bool is_empty() const { return !has_outcomes() && coincidences.empty(); }
};

// `learned` as a belief that grows from `prior`: to the last bit what it was if the prior is the
// same; otherwise the designer changed the rule file, and what was counted is added to the new one.
Belief grown_from(const Belief& prior, const LearnedBelief& learned);

// Adds what `other` counted to `learned`: beliefs, couplings, latencies and coincidences of a fleet
// become one.
void merge(Learned& learned, const Learned& other);

}  // namespace culprit::journal
