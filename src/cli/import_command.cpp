#include <map>
#include <memory>
#include <string_view>

#include <fmt/core.h>

#include "base/amount.h"
#include "base/name_grammar.h"
#include "base/text_file.h"
#include "cli/commands.h"
#include "import/importer.h"
#include "rule_json/from_json.h"

namespace culprit::cli {
namespace {

struct ImportOptions {
  std::string file;
  std::string output;
};

// Each note once, with the first line that it is about; the output has it at every place.
void print_summary(const ImportOptions& options, const foreign::Imported& imported) {
  fmt::print(stderr, "culprit: {}: {} imported, {} kept as comments, {}\n", options.file,
             amount_of(static_cast<std::size_t>(imported.rules), "rule"),
             imported.rules_as_comments, amount_of(imported.notes.size(), "note"));
  std::map<std::string_view, int> times;
  for (const foreign::Note& note : imported.notes) ++times[note.text];
  for (const foreign::Note& note : imported.notes) {
    int& count = times[note.text];
    if (count == 0) continue;
    const std::string line = note.line == 0 ? "" : fmt::format(":{}", note.line);
    const std::string more = count == 1 ? "" : fmt::format(" ({} places)", count);
    fmt::print(stderr, "{}{}: note: {}{}\n", options.file, line, escape_controls(note.text), more);
    count = 0;
  }
}

int import_foreign_rules(const ImportOptions& options, const Source& source) {
  const auto imported = foreign::import_rules(source);
  if (!imported) return fail(imported.error());
  if (const auto written = write_text(options.output, imported->text); !written)
    return fail(written.error());
  print_summary(options, *imported);
  return kOk;
}

int import_json(const ImportOptions& options, const Source& source) {
  const auto rules = rule_json::to_rules(source.name(), std::string(source.text()));
  if (!rules) {
    fmt::print(stderr, "{}", escape_lines(rules.error()));
    return fail(source.name() + " is not imported");
  }
  const auto written = write_text(options.output, *rules);
  return written ? kOk : fail(written.error());
}

// No rule file of the reference begins so.
bool is_json(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '{';
}

int import_file(const ImportOptions& options) {
  const auto source = Source::read(options.file);
  if (!source) return fail(source.error());
  return is_json(source->text()) ? import_json(options, *source)
                                 : import_foreign_rules(options, *source);
}

}  // namespace

void add_import(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* command = app.add_subcommand(
      "import",
      "Convert a rule file of the paper's reference manager (BEGIN CONSTS, BEGIN RULES), or the "
      "JSON of culprit export");
  command->add_option("FILE", options->file, "The file to convert")->type_name("FILE")->required();
  command->add_option("-o,--output", options->output, "Output file (default: stdout)")
      ->type_name("FILE");
  command->callback([options, &exit_code] { exit_code = import_file(*options); });
}

}  // namespace culprit::cli
