#include <memory>
#include <unistd.h>

#include <fmt/core.h>

#include "base/text_file.h"
#include "cli/commands.h"
#include "rule_json/to_json.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

struct ExportOptions {
  std::string file;
  std::string output;
  bool as_json = false;  // the only form so far, to be asked for
};

int export_json(const ExportOptions& options) {
  const auto text = read_text(options.file);
  if (!text) return fail(text.error());
  const std::string name = options.file == "-" ? "<stdin>" : options.file;
  const auto json = rule_json::to_json(Source(name, *text), colour_of(STDERR_FILENO));
  if (!json) {
    fmt::print(stderr, "{}", json.error());
    return fail(name + " is not exported");
  }
  const auto written = write_text(options.output, rule_json::to_text(*json));
  return written ? kOk : fail(written.error());
}

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand(
      "export", "Write a rule file in another form; culprit import reads it back");
  command->add_flag("--json", options->as_json, "As JSON: every statement, comment and blank line")
      ->required();
  command->add_option("RULES", options->file, "A rule file; - is the standard input")
      ->type_name("FILE")
      ->required();
  command->add_option("-o,--output", options->output, "Output file (default: stdout)")
      ->type_name("FILE");
  command->callback([options, &exit_code] { exit_code = export_json(*options); });
}

}  // namespace culprit::cli
