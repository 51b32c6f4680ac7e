// Rule files: every diagnostic must render, and every program of an accepted file must run, with
// inputs unknown and known.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "language/checker.h"
#include "language/evaluate.h"

namespace {

using namespace culprit;

Slot extreme(Type type) {
  switch (type) {
    case Type::kBool:
      return Slot::of(true);
    case Type::kInt:
      return Slot::of(std::numeric_limits<std::int64_t>::min());
    case Type::kDouble:
      return Slot::of(std::numeric_limits<double>::max());
    case Type::kString:
      return Slot::of(std::string_view("text"));
    case Type::kDuration:
      return Slot::of(Duration::max());
  }
  return {};
}

void run_all(const RuleSet& rules) {
  const std::vector<Slot> unknown(rules.inputs.size());
  std::vector<Slot> known;
  for (const Input& input : rules.inputs) known.push_back(extreme(input.type));
  const auto run = [&](const Program& program) {
    if (program.empty()) return;
    evaluate(program, unknown);
    evaluate(program, known);
  };
  for (const Rule& rule : rules.rules) run(rule.trigger);
  for (const Strategy& strategy : rules.strategies) {
    run(strategy.when);
    for (const Adaptation& adaptation : strategy.adaptations) run(adaptation.value);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Source source("fuzz.rules", std::string(reinterpret_cast<const char*>(data), size));
  const Checked checked = check(source, Strictness::kStrict);
  for (const Diagnostic& diagnostic : checked.diagnostics)
    if (render(diagnostic, source).empty()) __builtin_trap();
  if (const Checked lenient = check(source); lenient.rules) run_all(*lenient.rules);
  return 0;
}
