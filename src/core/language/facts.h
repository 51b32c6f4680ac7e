// Expressions that can be true: reasoning before anything runs.
//
// Facts are the possible values of inputs. At first they are what the input's kind allows (a rate
// is not negative) and its signal's RANGE; assuming that an expression is true or false narrows
// them. If no value is left, the assumption is certainly wrong. The reverse does not hold: a case
// that cannot be decided counts as possible, so a message that rests on an impossibility is never
// mistaken.
//
// Unknown values need no case of their own: a trigger fires only on true, and these are the values
// for which an expression is known to be true or false.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "language/rule_set.h"
#include "language/typing.h"
#include "language/value_set.h"

namespace culprit {

// The states of a managed node in which it stays.
inline constexpr std::array<std::string_view, 4> kLifecycleStates = {"unconfigured", "inactive",
                                                                     "active", "finalized"};
// The states that a lifecycle() or a group can be in; empty: `input` is none of these.
std::span<const std::string_view> states_of(const Input& input, const RuleSet& rules);

class Facts {
 public:
  // `rules` must outlive the facts.
  explicit Facts(const RuleSet& rules) : rules_(&rules) {}

  // Narrows the facts to where `condition` is known to be `truth`. False: nothing is left.
  // @pre condition.type is kBool
  bool assume(const Typed& condition, bool truth);

  ValueSet values_of(InputId input) const;
  // All values that the input has from now on.
  void know(InputId input, ValueSet values);
  void know(InputId number, const Interval& interval);

 private:
  // A comparison as "left before right", "left not after right" or "left equals right".
  enum class Order : std::uint8_t { kLess, kLessEqual, kEqual, kNotEqual };

  template <class First, class Second>
  bool either(First first, Second second);
  bool compare(const Typed& comparison, bool truth);
  bool compare_truths(const Typed& left, const Typed& right, bool truth);
  bool order(const Typed& left, const Typed& right, Order order);
  bool differ(const Typed& left, const Typed& right);
  bool narrow(const Typed& expression, const ValueSet& set);
  bool narrow(const Typed& number, const Interval& interval);
  void join(const Facts& other);
  ValueSet values_of(const Typed& expression) const;
  Interval interval_of(InputId number) const;
  Interval interval_of(const Typed& expression) const;

  const RuleSet* rules_;
  // Inputs with narrower facts than at first: numbers, and all others. They are few, for expressions
  // are small.
  template <class Set>
  using Known = std::vector<std::pair<InputId, Set>>;
  Known<Interval> numbers_;
  Known<ValueSet> others_;
};

// Expressions larger than this are not reasoned about, so that checking a hostile file takes time
// in proportion to its size.
bool is_small_enough(const Typed& expression);

// Certainly not true (false) with any values of its inputs.
bool is_never(bool truth, const Typed& condition, const RuleSet& rules);

}  // namespace culprit
