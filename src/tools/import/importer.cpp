#include "import/importer.h"

#include <algorithm>
#include <map>
#include <string_view>

#include "import/condition_dialect.h"
#include "import/file_reader.h"
#include "import/strategy_dialect.h"
#include "language/checker.h"

namespace culprit::foreign {
namespace {

// By the words that begin its lines. A file without any rule is as good in one as in the other.
Expected<File> read(const Source& source) {
  bool has_sections = false;
  for (std::uint32_t line = 1; line <= source.line_count(); ++line) {
    const auto words = split_words(source, source.line(line));
    if (words.empty()) continue;
    const std::string& head = words.front().text;
    has_sections |= head == "BEGIN";
    if (!has_sections && head == "RULE") break;
    if (head == "POLICIES" || head == "TRIGGER") return read_strategy_dialect(source);
    if (head == "COMPONENTS" || head == "IF") return read_condition_dialect(source);
  }
  if (has_sections) return read_strategy_dialect(source);
  return Error{source.name() +
               ":1:1: this is no rule file of the reference: it has no BEGIN RULES; if it is "
               "culprit's own, run culprit check"};
}

struct Text {
  std::string text;
  std::vector<std::uint32_t> block_starts;
};

Text assemble(const std::vector<Block>& blocks) {
  Text out;
  bool after_rule = true;
  for (const Block& block : blocks) {
    if (block.is_rule || after_rule) out.text += out.text.empty() ? "" : "\n";
    after_rule = block.is_rule || out.text.empty();
    out.block_starts.push_back(static_cast<std::uint32_t>(out.text.size()));
    for (const std::string& comment : block.comments) out.text += "# " + comment + "\n";
    for (const std::string& note : block.notes) out.text += "# note: " + note + "\n";
    for (const std::string& line : block.lines) out.text += line + "\n";
  }
  return out;
}

// Puts the lines of `block` into a comment, because of `why`.
void retract(Block& block, const std::string& why, std::vector<Note>& notes) {
  const std::string note =
      std::string(block.is_rule ? "this rule" : "this line") + " is kept as a comment: " + why;
  block.notes.push_back(note);
  notes.push_back({block.line, note});
  for (std::string& line : block.lines) line = "# " + line;
}

bool is_retracted(const Block& block) {
  return block.lines.empty() || block.lines.front().starts_with("# ");
}

// The errors of the present text, at most one for each block. A rule is retracted for its own
// mistakes only; but other rules may need the type of a signal that it gave, so this is repeated
// until no error is left.
std::map<std::size_t, std::string> mistakes(const Text& text) {
  std::map<std::size_t, std::string> found;
  const Source source("imported.rules", text.text);
  for (const Diagnostic& d : check(source).diagnostics) {
    if (d.severity != Severity::kError) continue;
    const auto after =
        std::upper_bound(text.block_starts.begin(), text.block_starts.end(), d.span.begin);
    const auto block = static_cast<std::size_t>(after - text.block_starts.begin()) - 1;
    found.emplace(block, d.cause + (d.remedy.empty() ? "" : "; " + d.remedy));
  }
  return found;
}

void retract_mistakes(std::vector<Block>& blocks, std::vector<Note>& notes) {
  constexpr int kRounds = 10;
  for (int round = 0;; ++round) {
    const auto found = mistakes(assemble(blocks));
    if (found.empty()) return;
    for (const auto& [block, why] : found) retract(blocks[block], why, notes);
    if (round < kRounds) continue;
    for (Block& block : blocks) {
      if (block.is_rule && !is_retracted(block))
        retract(block, "too much in this file contradicts itself", notes);
    }
  }
}

}  // namespace

Expected<Imported> import_rules(const Source& source) {
  if (source.text().size() > kMaxImport)
    return Error{source.name() + ": larger than 1 MiB; is it a rule file?"};
  if (source.text().find('\0') != std::string_view::npos)
    return Error{source.name() + ": this file is binary, not a rule file"};
  const auto file = read(source);
  if (!file) return Error{file.error()};
  Written written = write(*file, source.name());
  retract_mistakes(written.blocks, written.notes);

  Imported imported;
  imported.text = assemble(written.blocks).text;
  imported.notes = std::move(written.notes);
  for (const Block& block : written.blocks) {
    if (block.is_rule) ++(is_retracted(block) ? imported.rules_as_comments : imported.rules);
  }
  std::stable_sort(imported.notes.begin(), imported.notes.end(),
                   [](const Note& a, const Note& b) { return a.line < b.line; });
  return imported;
}

}  // namespace culprit::foreign
