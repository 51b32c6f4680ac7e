// Rule files, alone and against a robot: every diagnostic must render, and every program of an
// accepted file must run, with inputs unknown and known.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "language/evaluate.h"
#include "language/explanations.h"
#include "language/live_checks.h"

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

void look_at(const Diagnostic& diagnostic, const Source& source) {
  if (render(diagnostic, source).empty()) __builtin_trap();
  if (!diagnostic.fix) return;
  const Span span = diagnostic.fix->span;
  if (span.begin > span.end || span.end > source.text().size()) __builtin_trap();
  if (title_of(*diagnostic.fix, source).empty()) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Source source("fuzz.rules", std::string(reinterpret_cast<const char*>(data), size));
  for (const Checked& checked :
       {check(source, Strictness::kStrict), check_against(example_robot(), source)}) {
    for (const Diagnostic& diagnostic : checked.diagnostics) look_at(diagnostic, source);
    if (checked.rules) run_all(*checked.rules);
  }
  return 0;
}
