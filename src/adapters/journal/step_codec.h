// Steps of the manager as bytes: exactly what it was given, so that a replay gives exactly what it
// did.
//
// A row holds one or more steps, one behind the other:
//
//     now (integer, ns)  2 x count + has digest (natural)  count x observation  digest (8 bytes)
//
//     observation:  kind (byte)  now - at (integer, ns)  fields
//
// Things of the rule set are written by their number in it, so a row is read with the rule set of
// its session.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/expected.h"
#include "journal/bytes.h"
#include "language/rule_set.h"
#include "robot/observation.h"

namespace culprit::journal {

// Identifies all decisions of a step: its commands and events.
using Digest = std::uint64_t;

struct Step {
  Time now{};
  std::vector<Observation> observations;
  std::optional<Digest> digest;  // nothing: it decided nothing
};

void encode(Time now, std::span<const Observation> observations, std::optional<Digest> digest,
            ByteWriter& out);

// Reads the steps of one row. Errors: the bytes are damaged, or speak of things that `rules` does
// not have.
class StepReader {
 public:
  // `rules` and `bytes` must outlive the reader.
  StepReader(std::string_view bytes, const RuleSet& rules) : in_(bytes), rules_(rules) {}

  // False at the end. Reuses the memory of `step`.
  Expected<bool> next(Step& step);

 private:
  ByteReader in_;
  const RuleSet& rules_;
};

}  // namespace culprit::journal
