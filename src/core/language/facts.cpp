#include "language/facts.h"

#include <algorithm>

#include "base/invariant.h"

namespace culprit {
namespace {

// Far above what a person writes: ten comparisons are about 40 nodes.
constexpr std::size_t kMaxNodes = 120;

// How many nodes `e` has; some number above `limit` if there are more than that.
std::size_t node_count(const Typed& e, std::size_t limit) {
  std::size_t count = 1;
  for (const Typed& child : e.children) {
    if (count > limit) break;
    count += node_count(child, limit - count);
  }
  return count;
}

// A mean is summed up in floating point and may leave the range by a rounding error.
Interval with_rounding(const Interval& i) {
  const double slack = 1e-9 * (i.high - i.low);
  return {i.low - slack, i.high + slack};
}

Interval declared_range(const Signal& signal) {
  return signal.range ? Interval{signal.range->low, signal.range->high} : Interval{};
}

// @pre its type is a number
Interval first_interval(const Input& input, const RuleSet& rules) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  switch (input.kind) {
    case Input::Kind::kSignal:
      return input.type == Type::kDouble ? declared_range(rules[input.signal]) : Interval{};
    case Input::Kind::kMin:
    case Input::Kind::kMax:
      return declared_range(rules[input.signal]);
    case Input::Kind::kMean:
      return with_rounding(declared_range(rules[input.signal]));
    case Input::Kind::kStddev: {
      const Interval range = declared_range(rules[input.signal]);
      return {0, with_rounding({0, range.high - range.low}).high};
    }
    case Input::Kind::kRate:
    case Input::Kind::kAge:
    case Input::Kind::kPhi:
    case Input::Kind::kCpu:
    case Input::Kind::kMemory:
    case Input::Kind::kGoals:
    case Input::Kind::kGoalAge:
    case Input::Kind::kLogs:
      return {0, kInfinity};
    case Input::Kind::kLoss:
      return {0, 1};
    case Input::Kind::kLevel:
      return {0, 3};
    case Input::Kind::kLifecycle:
    case Input::Kind::kAlive:
    case Input::Kind::kParameter:
    case Input::Kind::kChanged:
    case Input::Kind::kIsNan:
    case Input::Kind::kFrozen:
      break;
  }
  return {};
}

bool is_number(Type type) { return type != Type::kBool && type != Type::kString; }

ValueSet first_values(const Input& input, const RuleSet& rules) {
  if (is_number(input.type)) return first_interval(input, rules);
  const auto states = states_of(input, rules);
  if (states.empty()) return all_values(input.type);
  TextSet set{{states.begin(), states.end()}, false};
  if (input.kind == Input::Kind::kLifecycle) set.texts.insert({"unknown", "in transition"});
  return set;
}

bool is_single(const Interval& i) { return i.low == i.high; }
bool is_single(const TextSet& t) { return !t.is_complement && t.texts.size() == 1; }

// ---- What is known of few inputs

// Null: not more than at first.
template <class Set>
const Set* find(InputId input, const std::vector<std::pair<InputId, Set>>& known) {
  for (const auto& [each, values] : known) {
    if (each == input) return &values;
  }
  return nullptr;
}

template <class Set>
void enter(InputId input, Set values, std::vector<std::pair<InputId, Set>>& known) {
  for (auto& [each, before] : known) {
    if (each != input) continue;
    before = std::move(values);
    return;
  }
  if (known.empty()) known.reserve(4);
  known.emplace_back(input, std::move(values));
}

// Keeps the facts that hold if either set of facts holds.
template <class Set>
void keep_joint(std::vector<std::pair<InputId, Set>>& known,
                const std::vector<std::pair<InputId, Set>>& other) {
  std::erase_if(known, [&](const auto& each) { return find(each.first, other) == nullptr; });
  for (auto& [input, values] : known) values = hull(values, *find(input, other));
}

// All values but the one of `single`, as far as an interval can leave one out.
Interval all_but(const Interval& single, const Interval& of) {
  Interval out = of;
  if (of.low == single.low) out.is_low_open = true;
  if (of.high == single.low) out.is_high_open = true;
  return out;
}

}  // namespace

std::span<const std::string_view> states_of(const Input& input, const RuleSet& rules) {
  static constexpr std::array<std::string_view, 5> kOfGroup = {"active", "half_up", "inactive",
                                                               "down", "changing"};
  const bool is_group = input.kind == Input::Kind::kSignal &&
                        std::holds_alternative<GroupId>(rules[input.signal].source);
  if (is_group) return kOfGroup;
  if (input.kind == Input::Kind::kLifecycle) return kLifecycleStates;
  return {};
}

ValueSet Facts::values_of(InputId input) const {
  if (is_number((*rules_)[input].type)) return interval_of(input);
  const ValueSet* known = find(input, others_);
  return known != nullptr ? *known : first_values((*rules_)[input], *rules_);
}

void Facts::know(InputId input, ValueSet values) {
  if (const auto* interval = std::get_if<Interval>(&values)) return know(input, *interval);
  enter(input, std::move(values), others_);
}

void Facts::know(InputId number, const Interval& interval) { enter(number, interval, numbers_); }

bool Facts::assume(const Typed& e, bool truth) {
  CULPRIT_ASSERT(e.type == Type::kBool);
  const auto child = [&](std::size_t i, bool t) {
    return [&e, i, t](Facts& f) { return f.assume(e.children[i], t); };
  };
  switch (e.op) {
    case Op::kConstant:
    case Op::kInput:
      return narrow(e, TruthSet{truth, !truth});
    case Op::kNot:
      return assume(e.children[0], !truth);
    case Op::kAnd:
    case Op::kOr: {
      const bool both = (e.op == Op::kAnd) == truth;
      if (both) return assume(e.children[0], truth) && assume(e.children[1], truth);
      return either(child(0, truth), child(1, truth));
    }
    case Op::kSelect: {
      const auto yes = [&](Facts& f) {
        return f.assume(e.children[0], true) && f.assume(e.children[1], truth);
      };
      const auto no = [&](Facts& f) {
        return f.assume(e.children[0], false) && f.assume(e.children[2], truth);
      };
      return either(yes, no);
    }
    default:
      return compare(e, truth);
  }
}

template <class First, class Second>
bool Facts::either(First first, Second second) {
  Facts other = *this;
  const bool is_first_possible = first(*this);
  const bool is_second_possible = second(other);
  if (is_first_possible && is_second_possible) join(other);
  if (!is_first_possible) *this = std::move(other);
  return is_first_possible || is_second_possible;
}

void Facts::join(const Facts& other) {
  keep_joint(numbers_, other.numbers_);
  keep_joint(others_, other.others_);
}

bool Facts::compare(const Typed& e, bool truth) {
  const Typed& left = e.children[0];
  const Typed& right = e.children[1];
  switch (e.op) {
    case Op::kLessInt:
    case Op::kLessDouble:
      return truth ? order(left, right, Order::kLess) : order(right, left, Order::kLessEqual);
    case Op::kLessEqualInt:
    case Op::kLessEqualDouble:
      return truth ? order(left, right, Order::kLessEqual) : order(right, left, Order::kLess);
    case Op::kEqualInt:
    case Op::kEqualDouble:
    case Op::kEqualString: {
      if (!truth) return differ(left, right);
      const ValueSet theirs = values_of(right);
      return narrow(right, values_of(left)) && narrow(left, theirs);
    }
    case Op::kEqualBool:
      return compare_truths(left, right, truth);
    default:
      return true;  // the order of texts is not reasoned about
  }
}

// Only with a constant: reasoning about two conditions at once would have to try all their cases.
bool Facts::compare_truths(const Typed& left, const Typed& right, bool truth) {
  if (right.op == Op::kConstant) return assume(left, right.constant->slot.b == truth);
  if (left.op == Op::kConstant) return assume(right, left.constant->slot.b == truth);
  return true;
}

bool Facts::order(const Typed& left, const Typed& right, Order order) {
  const Interval a = interval_of(left);
  const Interval b = interval_of(right);
  const bool strict = order == Order::kLess;
  Interval below;
  below.high = b.high;
  below.is_high_open = strict || b.is_high_open;
  Interval above;
  above.low = a.low;
  above.is_low_open = strict || a.is_low_open;
  return narrow(left, below) && narrow(right, above);
}

bool Facts::differ(const Typed& left, const Typed& right) {
  const ValueSet a = values_of(left);
  const ValueSet b = values_of(right);
  if (is_number(left.type)) {
    const auto& x = std::get<Interval>(a);
    const auto& y = std::get<Interval>(b);
    if (is_single(y)) return narrow(left, all_but(y, x));
    return !is_single(x) || narrow(right, all_but(x, y));
  }
  auto x = std::get<TextSet>(a);
  auto y = std::get<TextSet>(b);
  if (is_single(y)) {
    y.is_complement = true;
    return narrow(left, y);
  }
  x.is_complement = true;
  return !is_single(std::get<TextSet>(a)) || narrow(right, x);
}

bool Facts::narrow(const Typed& e, const ValueSet& set) {
  if (const auto* interval = std::get_if<Interval>(&set)) return narrow(e, *interval);
  ValueSet narrowed = intersection(values_of(e), set);
  const bool possible = !is_empty(narrowed);
  if (e.op == Op::kInput) know(e.input, std::move(narrowed));
  return possible;
}

// Most facts are about numbers, which need no set that might be of another type.
bool Facts::narrow(const Typed& e, const Interval& interval) {
  const Typed& leaf = e.op == Op::kIntToDouble ? e.children[0] : e;
  if (leaf.op != Op::kInput) return !is_empty(intersection(interval_of(e), interval));
  Interval narrowed = intersection(interval_of(leaf), interval);
  const bool is_whole = leaf.type == Type::kInt || leaf.type == Type::kDuration;
  if (is_whole) narrowed = whole_numbers(narrowed);
  know(leaf.input, narrowed);
  return !is_empty(narrowed);
}

Interval Facts::interval_of(InputId number) const {
  const Interval* known = find(number, numbers_);
  return known != nullptr ? *known : first_interval((*rules_)[number], *rules_);
}

Interval Facts::interval_of(const Typed& e) const {
  if (e.op == Op::kInput) return interval_of(e.input);
  if (e.op == Op::kConstant) return only_number(*e.constant, e.type);
  return std::get<Interval>(values_of(e));
}

ValueSet Facts::values_of(const Typed& e) const {
  switch (e.op) {
    case Op::kConstant:
      return only_value(*e.constant, e.type);
    case Op::kInput:
      return values_of(e.input);
    case Op::kSelect:
      return hull(values_of(e.children[1]), values_of(e.children[2]));
    default:
      break;
  }
  if (!is_number(e.type)) return all_values(e.type);
  return apply(e.op, interval_of(e.children[0]),
               e.children.size() > 1 ? interval_of(e.children[1]) : Interval{});
}

bool is_small_enough(const Typed& expression) {
  return node_count(expression, kMaxNodes) <= kMaxNodes;
}

bool is_never(bool truth, const Typed& condition, const RuleSet& rules) {
  if (!is_small_enough(condition)) return false;
  Facts facts(rules);
  if (!facts.assume(condition, truth)) return true;
  // The second part of a condition may rule out a case of the first: look twice.
  const bool has_parts = std::any_of(condition.children.begin(), condition.children.end(),
                                     [](const Typed& c) { return c.type == Type::kBool; });
  return has_parts && !facts.assume(condition, truth);
}

}  // namespace culprit
