// The values that an expression can have, as far as is known before anything runs.
//
// Each set holds at least the values that are possible, and may hold more: a value that is not in
// the set is certainly impossible. Every operation keeps that promise.
#pragma once

#include <limits>
#include <set>
#include <string>
#include <variant>

#include "language/program.h"

namespace culprit {

// The numbers from `low` to `high`. Whole numbers and durations (in nanoseconds) are counted as
// doubles; an end beyond 2^53, where doubles no longer tell neighbours apart, becomes infinite.
struct Interval {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool is_low_open = false;  // `low` itself does not belong to it
  bool is_high_open = false;
  bool operator==(const Interval&) const = default;
};

// The texts in `texts`, or all others.
struct TextSet {
  std::set<std::string> texts;
  bool is_complement = true;
  bool operator==(const TextSet&) const = default;
};

struct TruthSet {
  bool may_be_true = true;
  bool may_be_false = true;
  bool operator==(const TruthSet&) const = default;
};

using ValueSet = std::variant<Interval, TextSet, TruthSet>;

// All values of a type.
ValueSet all_values(Type type);
// The one value of a constant of that type.
ValueSet only_value(const Constant& constant, Type type);
// The same. @pre the type is a number
Interval only_number(const Constant& constant, Type type);

bool is_empty(const ValueSet& set);
bool is_empty(const Interval& interval);
Interval intersection(const Interval& a, const Interval& b);
// @pre both sets are of the same kind
ValueSet intersection(const ValueSet& a, const ValueSet& b);
// The smallest set that holds both. @pre both sets are of the same kind
ValueSet hull(const ValueSet& a, const ValueSet& b);
Interval hull(const Interval& a, const Interval& b);

// The interval without the ends that no whole number reaches: 2 < x < 5 becomes 3 <= x <= 4.
Interval whole_numbers(Interval interval);

// The results of an instruction that makes a number of numbers. `b` does not count for those with
// one operand.
Interval apply(Op op, const Interval& a, const Interval& b);

}  // namespace culprit
