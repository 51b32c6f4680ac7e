#include <cstdio>
#include <map>
#include <memory>
#include <string_view>

#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/text_file.h"
#include "language/import/importer.h"

namespace culprit::cli {
namespace {

struct ImportOptions {
  std::string file;
  std::string output;
};

// Each note once, with the first line that it is about; the output has it at every place.
void print_summary(const ImportOptions& options, const Imported& imported) {
  fmt::print(stderr, "culprit: {}: {} rules imported, {} kept as comments, {} notes\n",
             options.file, imported.rules, imported.rules_as_comments, imported.notes.size());
  std::map<std::string_view, int> times;
  for (const foreign::Note& note : imported.notes) ++times[note.text];
  for (const foreign::Note& note : imported.notes) {
    int& count = times[note.text];
    if (count == 0) continue;
    const std::string line = note.line == 0 ? "" : fmt::format(":{}", note.line);
    const std::string more = count == 1 ? "" : fmt::format(" ({} places)", count);
    fmt::print(stderr, "{}{}: note: {}{}\n", options.file, line, note.text, more);
    count = 0;
  }
}

int import_file(const ImportOptions& options) {
  const auto source = Source::read(options.file);
  const auto imported = source ? import_rules(*source) : Expected<Imported>(Error{source.error()});
  if (!imported) {
    fmt::print(stderr, "culprit: {}\n", imported.error());
    return kFailed;
  }
  if (options.output.empty()) {
    fmt::print("{}", imported->text);
  } else if (const auto written = write_text(options.output, imported->text); !written) {
    fmt::print(stderr, "culprit: {}\n", written.error());
    return kFailed;
  }
  print_summary(options, *imported);
  return kOk;
}

}  // namespace

void add_import(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* command = app.add_subcommand(
      "import", "Convert a rule file of the paper's reference manager (BEGIN CONSTS, BEGIN RULES)");
  command->add_option("FILE", options->file, "The file to convert")->required();
  command->add_option("-o,--output", options->output, "Where to write the rules (default: stdout)");
  command->callback([options, &exit_code] { exit_code = import_file(*options); });
}

}  // namespace culprit::cli
