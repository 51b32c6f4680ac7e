#include <memory>

#include <fmt/core.h>

#include "cli/commands.h"
#include "language/explanations.h"

namespace culprit::cli {
namespace {

struct ExplainOptions {
  std::string code;
  bool markdown = false;
};

int explain(const ExplainOptions& options) {
  if (options.markdown) {
    fmt::print("{}", diagnostics_as_markdown());
    return kOk;
  }
  if (options.code.empty()) {
    for (const Explanation& e : explanations()) fmt::print("{}  {}\n", to_string(e.code), e.title);
    return kOk;
  }
  const Explanation* explanation = find_explanation(options.code);
  if (explanation == nullptr) {
    fmt::print(stderr,
               "culprit: there is no diagnostic '{}'; culprit explain without a code lists all\n",
               options.code);
    return kUsage;
  }
  fmt::print("{}", page(*explanation));
  return kOk;
}

}  // namespace

void add_explain(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ExplainOptions>();
  CLI::App* command =
      app.add_subcommand("explain", "Explain what culprit check says: R012, or all codes");
  auto* code = command->add_option("CODE", options->code, "The code of a diagnostic, as in R012");
  command->add_flag("--markdown", options->markdown, "All explanations, as docs/diagnostics.md")
      ->excludes(code);
  command->callback([options, &exit_code] { exit_code = explain(*options); });
}

}  // namespace culprit::cli
