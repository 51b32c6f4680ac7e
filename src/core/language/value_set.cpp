#include "language/value_set.h"

#include <algorithm>
#include <cmath>

#include "base/invariant.h"

namespace culprit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kExact = 9007199254740992.0;  // 2^53

Interval meet(const Interval& a, const Interval& b) {
  Interval out = a;
  if (b.low > a.low || (b.low == a.low && b.is_low_open)) {
    out.low = b.low;
    out.is_low_open = b.is_low_open;
  }
  if (b.high < a.high || (b.high == a.high && b.is_high_open)) {
    out.high = b.high;
    out.is_high_open = b.is_high_open;
  }
  return out;
}

Interval join(const Interval& a, const Interval& b) {
  Interval out = a;
  if (b.low < a.low || (b.low == a.low && !b.is_low_open)) {
    out.low = b.low;
    out.is_low_open = b.is_low_open;
  }
  if (b.high > a.high || (b.high == a.high && !b.is_high_open)) {
    out.high = b.high;
    out.is_high_open = b.is_high_open;
  }
  return out;
}

using Texts = std::set<std::string>;

Texts both(const Texts& a, const Texts& b) {
  Texts out;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::inserter(out, out.end()));
  return out;
}
Texts either(const Texts& a, const Texts& b) {
  Texts out;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::inserter(out, out.end()));
  return out;
}
Texts without(const Texts& a, const Texts& b) {
  Texts out;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::inserter(out, out.end()));
  return out;
}

TextSet meet(const TextSet& a, const TextSet& b) {
  if (a.is_complement && b.is_complement) return {either(a.texts, b.texts), true};
  if (a.is_complement) return {without(b.texts, a.texts), false};
  if (b.is_complement) return {without(a.texts, b.texts), false};
  return {both(a.texts, b.texts), false};
}

TextSet inverse(TextSet set) {
  set.is_complement = !set.is_complement;
  return set;
}

TextSet join(const TextSet& a, const TextSet& b) { return inverse(meet(inverse(a), inverse(b))); }

TruthSet meet(TruthSet a, TruthSet b) {
  return {a.may_be_true && b.may_be_true, a.may_be_false && b.may_be_false};
}
TruthSet join(TruthSet a, TruthSet b) {
  return {a.may_be_true || b.may_be_true, a.may_be_false || b.may_be_false};
}

// Doubles that stand for whole numbers are exact only up to 2^53.
Interval exact(Interval i) {
  if (!(std::fabs(i.low) < kExact)) i.low = -kInfinity;
  if (!(std::fabs(i.high) < kExact)) i.high = kInfinity;
  return i;
}

// For operations that are monotonic in each operand: the extremes are at the corners. Rounding is
// monotonic too, so the corners as rounded hold all results as rounded; an open end may be reached
// by rounding and counts as closed.
template <class Operation>
Interval corners(const Interval& a, const Interval& b, Operation operation) {
  Interval out{kInfinity, -kInfinity};
  for (const double x : {a.low, a.high}) {
    for (const double y : {b.low, b.high}) {
      const double result = operation(x, y);
      if (std::isnan(result)) return {};
      out.low = std::min(out.low, result);
      out.high = std::max(out.high, result);
    }
  }
  return out;
}

template <class Operation>
Interval quotient(const Interval& a, const Interval& b, Operation operation) {
  if (b.low <= 0 && b.high >= 0) return {};
  return corners(a, b, operation);
}

Interval magnitude(const Interval& a) {
  if (a.low >= 0) return a;
  const Interval negated{-a.high, -a.low, a.is_high_open, a.is_low_open};
  if (a.high <= 0) return negated;
  return {0, std::max(-a.low, a.high)};
}

}  // namespace

ValueSet all_values(Type type) {
  if (type == Type::kBool) return TruthSet{};
  if (type == Type::kString) return TextSet{};
  return Interval{};
}

ValueSet only_value(const Constant& constant, Type type) {
  if (type == Type::kBool) return TruthSet{constant.slot.b, !constant.slot.b};
  if (type == Type::kString) return TextSet{{constant.text}, false};
  return only_number(constant, type);
}

Interval only_number(const Constant& constant, Type type) {
  if (type == Type::kDouble) return {constant.slot.d, constant.slot.d};
  const auto number = static_cast<double>(constant.slot.i);
  return exact({number, number});
}

bool is_empty(const Interval& i) {
  return i.low > i.high || (i.low == i.high && (i.is_low_open || i.is_high_open));
}

bool is_empty(const ValueSet& set) {
  if (const auto* interval = std::get_if<Interval>(&set)) return is_empty(*interval);
  if (const auto* texts = std::get_if<TextSet>(&set))
    return !texts->is_complement && texts->texts.empty();
  const auto& truth = std::get<TruthSet>(set);
  return !truth.may_be_true && !truth.may_be_false;
}

Interval intersection(const Interval& a, const Interval& b) { return meet(a, b); }

ValueSet intersection(const ValueSet& a, const ValueSet& b) {
  CULPRIT_ASSERT(a.index() == b.index());
  return std::visit([&]<class Set>(const Set& s) { return ValueSet(meet(s, std::get<Set>(b))); },
                    a);
}

ValueSet hull(const ValueSet& a, const ValueSet& b) {
  CULPRIT_ASSERT(a.index() == b.index());
  return std::visit([&]<class Set>(const Set& s) { return ValueSet(join(s, std::get<Set>(b))); },
                    a);
}

Interval hull(const Interval& a, const Interval& b) { return join(a, b); }

Interval whole_numbers(Interval i) {
  if (std::isfinite(i.low)) {
    const double up = std::ceil(i.low);
    i.low = i.is_low_open && up == i.low ? up + 1 : up;
  }
  if (std::isfinite(i.high)) {
    const double down = std::floor(i.high);
    i.high = i.is_high_open && down == i.high ? down - 1 : down;
  }
  i.is_low_open = i.is_high_open = false;
  return i;
}

Interval apply(Op op, const Interval& a, const Interval& b) {
  const auto add = [](double x, double y) { return x + y; };
  const auto subtract = [](double x, double y) { return x - y; };
  const auto multiply = [](double x, double y) { return x * y; };
  const auto divide = [](double x, double y) { return x / y; };
  const auto scale = [](double x, double y) { return std::nearbyint(x * y); };
  const auto shrink = [](double x, double y) { return std::nearbyint(x / y); };
  switch (op) {
    case Op::kIntToDouble:
      return a;
    case Op::kNegateInt:
    case Op::kNegateDouble:
      return {-a.high, -a.low, a.is_high_open, a.is_low_open};
    case Op::kAbsInt:
    case Op::kAbsDouble:
      return magnitude(a);
    case Op::kAddInt:
      return exact(corners(a, b, add));
    case Op::kAddDouble:
      return corners(a, b, add);
    case Op::kSubtractInt:
      return exact(corners(a, b, subtract));
    case Op::kSubtractDouble:
      return corners(a, b, subtract);
    case Op::kMultiplyInt:
      return exact(corners(a, b, multiply));
    case Op::kMultiplyDouble:
      return corners(a, b, multiply);
    case Op::kDivideInt:
      return exact(quotient(a, b, [](double x, double y) { return std::trunc(x / y); }));
    case Op::kDivideDouble:
    case Op::kRatio:
      return quotient(a, b, divide);
    case Op::kScale:
      return exact(corners(a, b, scale));
    case Op::kShrink:
      return exact(quotient(a, b, shrink));
    case Op::kMinInt:
    case Op::kMinDouble:
      return corners(a, b, [](double x, double y) { return std::min(x, y); });
    case Op::kMaxInt:
    case Op::kMaxDouble:
      return corners(a, b, [](double x, double y) { return std::max(x, y); });
    case Op::kSquareRoot:
      return {0, kInfinity};
    default:
      return {};
  }
}

}  // namespace culprit
