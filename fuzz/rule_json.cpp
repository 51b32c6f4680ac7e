// JSON forms of rule sets: an imported document parses, is canonical, and comes back from its own
// export. Other input is taken for a rule file, and comes back from its export, too.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "language/formatter.h"
#include "language/parser.h"
#include "language/test_tree.h"
#include "rule_json/from_json.h"
#include "rule_json/to_json.h"

namespace {

using namespace culprit;

std::string tree_of(const Source& source) {
  std::vector<Diagnostic> diagnostics;
  return tree_text(parse(source, diagnostics));
}

// Exported and imported again; nothing if it cannot be exported.
void come_back(const Source& source) {
  const auto json = rule_json::to_json(source);
  if (!json) return;
  const auto rules = rule_json::to_rules("fuzz.json", rule_json::to_text(*json));
  if (!rules || tree_of(Source("back.rules", *rules)) != tree_of(source)) __builtin_trap();
  if (*rules != *format(source)) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  come_back(Source("fuzz.rules", text));
  const auto rules = rule_json::to_rules("fuzz.json", text);
  if (!rules) {
    if (rules.error().empty()) __builtin_trap();
    return 0;
  }
  const Source source("imported.rules", *rules);
  if (!rule_json::to_json(source)) __builtin_trap();
  come_back(source);
  return 0;
}
