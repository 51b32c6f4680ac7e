// Rule files, with what they include and use put in, alone and against a robot: every diagnostic must
// render, every byte must come from somewhere, and every program of an accepted file must run, with
// inputs unknown and known.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "language/evaluate.h"
#include "language/test_example_robot.h"
#include "live_checks/live_checks.h"

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
  const LocatedDiagnostic here = located(diagnostic, source);
  if (!here.fix) return;
  const Source& file = source.file(here.place.file);
  const Span span = here.fix->span;
  if (span.begin > span.end || span.end > file.text().size()) __builtin_trap();
  if (title_of(*here.fix, file).empty()) __builtin_trap();
}

// "self.rules" is the input, so that files include themselves and one another.
Expected<Source> load(const std::string& file, const std::string& text) {
  if (file == "self.rules") return Source("self.rules", text);
  if (file == "driver.rules")
    return Source(
        "driver.rules",
        "TEMPLATE driver(name, topic, hz = 10)\n  CONST slow = {hz} * 0.5\n  RULE {name}_slow\n"
        "    POLICIES ERROR\n    TRIGGER rate({topic}) < slow\n      STRATEGY s 50 10\n"
        "        ADAPTATION {name} restart 5\nEND\n");
  return Error{"there is no '" + file + "'"};
}

void look_at_origins(const Source& source) {
  const auto size = static_cast<std::uint32_t>(source.text().size());
  for (std::uint32_t at = 0; at < size; at += 1 + at / 64) {
    const Origin origin = source.origin({at, at + 1});
    const Source& file = source.file(origin.place.file);
    if (origin.place.span.end > file.text().size()) __builtin_trap();
    if (origin.is_exact && file.text(origin.place.span) != source.text({at, at + 1}))
      __builtin_trap();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const Expansion rules =
      expand(Source("fuzz.rules", text),
             [&](const std::string& file, const std::string&) { return load(file, text); });
  look_at_origins(rules.source);
  for (const Checked& checked :
       {check(rules, Strictness::kStrict), live_checks::check_against(example_robot(), rules)}) {
    for (const Diagnostic& diagnostic : checked.diagnostics) look_at(diagnostic, rules.source);
    if (checked.rules) run_all(*checked.rules);
  }
  return 0;
}
