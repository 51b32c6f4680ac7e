#include "cli/load_rules.h"

#include <unistd.h>

#include <fmt/core.h>

#include "terminal/console.h"

namespace culprit::cli {

std::unique_ptr<const RuleSet> load_rules(const std::string& path) {
  auto loaded = live::read_rules(path, Strictness::kLenient, colour_of(STDERR_FILENO));
  if (!loaded) {
    fmt::print(stderr, "culprit: {}\n", loaded.error());
    return nullptr;
  }
  fmt::print(stderr, "{}", loaded->remarks);
  return std::make_unique<const RuleSet>(std::move(loaded->rules));
}

}  // namespace culprit::cli
