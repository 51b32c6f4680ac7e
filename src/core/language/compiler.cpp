#include "language/compiler.h"

#include <algorithm>

#include "language/evaluate.h"

namespace culprit {
namespace {

void emit(const Typed& e, Program& program) {
  for (const Typed& child : e.children) emit(child, program);
  std::uint32_t operand = 0;
  if (e.op == Op::kConstant) {
    operand = static_cast<std::uint32_t>(program.constants.size());
    program.constants.push_back(*e.constant);
  } else if (e.op == Op::kInput) {
    operand = e.input.index;
  }
  program.code.push_back({e.op, operand});
}

// How much emit() will enter.
void count(const Typed& e, std::size_t& nodes, std::size_t& constants) {
  ++nodes;
  if (e.op == Op::kConstant) ++constants;
  for (const Typed& child : e.children) count(child, nodes, constants);
}

bool is_plain_input(const Typed& e) {
  return e.op == Op::kInput || (e.op == Op::kIntToDouble && e.children[0].op == Op::kInput);
}

// The number that an input is compared with, as the monitor counts: durations in seconds.
double threshold(const Typed& constant) {
  const bool is_plain = constant.op == Op::kConstant;
  const Slot slot = is_plain ? constant.constant->slot : evaluate(compile(constant), {});
  if (constant.type == Type::kDouble) return slot.d;
  return constant.type == Type::kDuration ? seconds(Duration(slot.i)) : static_cast<double>(slot.i);
}

}  // namespace

Program compile(const Typed& expression) {
  Program program;
  program.type = expression.type;
  std::size_t nodes = 0, constants = 0;
  count(expression, nodes, constants);
  program.code.reserve(nodes);
  program.constants.reserve(constants);
  emit(expression, program);
  return program;
}

std::size_t stack_need(const Typed& expression) {
  std::size_t need = 1;
  for (std::size_t i = 0; i < expression.children.size(); ++i) {
    need = std::max(need, i + stack_need(expression.children[i]));
  }
  return need;
}

bool reads_inputs(const Typed& expression) {
  return expression.op == Op::kInput ||
         std::any_of(expression.children.begin(), expression.children.end(),
                     [](const Typed& c) { return reads_inputs(c); });
}

std::vector<double> thresholds_of(const Typed& comparison) {
  if (comparison.op == Op::kNot) return thresholds_of(comparison.children[0]);
  if (!compares_numbers(comparison.op)) return {};
  for (const std::size_t side : {0u, 1u}) {
    const Typed& there = comparison.children[1 - side];
    if (is_plain_input(comparison.children[side]) && !reads_inputs(there))
      return {threshold(there)};
  }
  return {};
}

void collect_thresholds(const Typed& trigger, std::vector<Input>& inputs) {
  if (trigger.op == Op::kInput) inputs[trigger.input.index].only_compared = false;
  if (compares_numbers(trigger.op)) {
    for (const int side : {0, 1}) {
      const Typed& here = trigger.children[static_cast<std::size_t>(side)];
      const Typed& there = trigger.children[static_cast<std::size_t>(1 - side)];
      if (!is_plain_input(here) || reads_inputs(there)) continue;
      const Typed& leaf = here.op == Op::kInput ? here : here.children[0];
      inputs[leaf.input.index].thresholds.push_back(threshold(there));
      return;
    }
  }
  for (const Typed& child : trigger.children) collect_thresholds(child, inputs);
}

}  // namespace culprit
