#include "rule_test/file_run.h"

#include <filesystem>

#include "language/checker.h"
#include "rule_files/rule_files.h"

namespace culprit::rule_test {
namespace {

struct Part {
  std::string rules_path;
  RuleSet rules;
  Suite suite;
};

// The tests as they are read for one rule file. Empty if there are errors.
std::optional<Part> read_part(const Source& source, Span name, const std::string& rules_path,
                              Colour colour, std::string& complaints) {
  const auto rules = rule_files::read(rules_path);
  if (!rules) {
    complaints +=
        render(Diagnostic{Code::kCannotInclude, Severity::kError, name, rules.error(), ""}, source,
               colour);
    return std::nullopt;
  }
  Checked checked = check(*rules);
  complaints += render(checked.diagnostics, rules->source, colour);
  if (!checked.rules) return std::nullopt;
  std::vector<Diagnostic> diagnostics;
  Suite suite = read_suite(source, *checked.rules, diagnostics);
  complaints += render(diagnostics, source, colour);
  if (!diagnostics.empty()) return std::nullopt;
  return Part{rules_path, std::move(*checked.rules), std::move(suite)};
}

void run_part(const Source& source, const Part& part, const std::string& filter,
              const PlannerFactory& planner, FileRun& run) {
  SuiteReport suite{source.name() + " with " + part.rules_path, {}};
  run.output += suite.name + "\n";
  for (const Test& test : part.suite.tests) {
    if (test.name.find(filter) == std::string::npos) continue;
    const Result result = run_test(part.rules, part.suite, test, planner());
    std::string text = report(result, source, part.rules);
    run.output += text;
    suite.cases.push_back({test.name, test.length, result.is_ok() ? "" : std::move(text)});
  }
  run.suites.push_back(std::move(suite));
}

}  // namespace

FileRun run_file(const std::string& path, const std::string& filter, const PlannerFactory& planner,
                 Colour colour) {
  FileRun run;
  const auto source = Source::read(path);
  if (!source) {
    run.complaints = "culprit: " + source.error() + "\n";
    return run;
  }
  std::vector<Diagnostic> diagnostics;
  const std::vector<syntax::Name> files = rule_files(*source, diagnostics);
  run.complaints = render(diagnostics, *source, colour);
  if (!diagnostics.empty()) return run;

  std::vector<Part> parts;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  for (const syntax::Name& file : files) {
    const std::string rules_path = (folder / file.text).lexically_normal().string();
    auto part = read_part(*source, file.span, rules_path, colour, run.complaints);
    if (!part) continue;
    for (Test& test : part->suite.tests) {
      if (!test.bag.empty()) test.bag = (folder / test.bag).lexically_normal().string();
    }
    parts.push_back(std::move(*part));
  }
  run.is_usable = parts.size() == files.size();
  if (!run.is_usable) return run;
  for (const Part& part : parts) run_part(*source, part, filter, planner, run);
  return run;
}

}  // namespace culprit::rule_test
