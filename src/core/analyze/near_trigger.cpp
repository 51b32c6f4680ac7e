#include "analyze/near_trigger.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace culprit {
namespace {

bool compares_whole_numbers(Op op) {
  return op == Op::kLessInt || op == Op::kLessEqualInt || op == Op::kEqualInt;
}

bool is_true(Op op, double left, double right) {
  if (op == Op::kLessInt || op == Op::kLessDouble) return left < right;
  if (op == Op::kLessEqualInt || op == Op::kLessEqualDouble) return left <= right;
  return left == right;
}

// One side of a comparison, as it is pushed.
struct Operand {
  Instruction push;
  bool is_converted = false;  // from a whole number
  std::size_t end = 0;        // of its instructions
};

Operand operand(const std::vector<Instruction>& code, std::size_t at) {
  const bool is_converted = at + 1 < code.size() && code[at + 1].op == Op::kIntToDouble;
  return {code[at], is_converted, at + (is_converted ? 2 : 1)};
}

double number(const Slot& slot, bool is_whole) {
  return is_whole ? static_cast<double>(slot.i) : slot.d;
}

double distance(double a, double b) {
  const double larger = std::max(std::abs(a), std::abs(b));
  return larger == 0 ? 0 : std::abs(a - b) / larger;
}

// The comparison that begins at `at` in the program: an input, a constant (in either order), and
// what compares them.
std::optional<NearTrigger> comparison(RuleId rule, std::size_t at, const Knowledge& knowledge) {
  const Program& trigger = knowledge.rules[rule].trigger;
  const auto& code = trigger.code;
  const Operand left = operand(code, at);
  if (left.end >= code.size()) return std::nullopt;
  const Operand right = operand(code, left.end);
  if (right.end >= code.size() || !compares_numbers(code[right.end].op)) return std::nullopt;
  const bool input_first = left.push.op == Op::kInput && right.push.op == Op::kConstant;
  const bool input_last = left.push.op == Op::kConstant && right.push.op == Op::kInput;
  if (!input_first && !input_last) return std::nullopt;

  const Operand& read = input_first ? left : right;
  const Operand& given = input_first ? right : left;
  const InputId input(read.push.operand);
  const Slot& slot = knowledge.signals[input];
  if (!slot.known) return std::nullopt;
  const Op op = code[right.end].op;
  const bool of_whole = compares_whole_numbers(op);
  const double value = number(slot, of_whole || read.is_converted);
  const double threshold =
      number(trigger.constants[given.push.operand].slot, of_whole || given.is_converted);
  const auto rest = std::span(code).subspan(right.end + 1);
  const bool is_negated = !rest.empty() && rest.front().op == Op::kNot;
  const bool holds = input_first ? is_true(op, value, threshold) : is_true(op, threshold, value);
  if (holds != is_negated) return std::nullopt;
  const double unit = knowledge.rules[input].type == Type::kDuration ? seconds(Duration(1)) : 1;
  return NearTrigger{rule, input, unit * value, unit * threshold, distance(value, threshold)};
}

std::optional<NearTrigger> nearest(RuleId rule, const Knowledge& knowledge) {
  constexpr double kNear = 0.5;
  std::optional<NearTrigger> nearest;
  for (std::size_t at = 0; at < knowledge.rules[rule].trigger.code.size(); ++at) {
    const auto found = comparison(rule, at, knowledge);
    if (!found || found->distance > kNear) continue;
    if (!nearest || found->distance < nearest->distance) nearest = found;
  }
  return nearest;
}

}  // namespace

std::vector<NearTrigger> near_triggers(const Knowledge& knowledge, std::size_t most) {
  std::vector<NearTrigger> found;
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    if (knowledge.states[RuleId(r)].phase != RulePhase::kQuiet) continue;
    if (const auto near = nearest(RuleId(r), knowledge)) found.push_back(*near);
  }
  std::stable_sort(found.begin(), found.end(), [](const NearTrigger& a, const NearTrigger& b) {
    return a.distance < b.distance;
  });
  if (found.size() > most) found.resize(most);
  return found;
}

}  // namespace culprit
