#include "cli/rule_file.h"

#include <unistd.h>

#include <fmt/core.h>

#include "cli/console.h"

namespace culprit::cli {

std::unique_ptr<const RuleSet> load_rules(const std::string& path, Strictness strictness) {
  const auto source = Source::read(path);
  if (!source) {
    fmt::print(stderr, "culprit: {}\n", source.error());
    return nullptr;
  }
  Checked checked = check(*source, strictness);
  for (const Diagnostic& d : checked.diagnostics)
    fmt::print(stderr, "{}", render(d, *source, colour_of(STDERR_FILENO)));
  if (!checked.rules) {
    fmt::print(stderr, "culprit: {} has errors\n", path);
    return nullptr;
  }
  return std::make_unique<const RuleSet>(std::move(*checked.rules));
}

}  // namespace culprit::cli
