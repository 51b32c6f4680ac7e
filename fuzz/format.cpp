// Formatting: whatever parses gets a layout that says the same and is its own layout.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "language/formatter.h"
#include "language/parser.h"
#include "language/test_tree.h"

namespace {

using namespace culprit;

std::string tree_of(const Source& source) {
  std::vector<Diagnostic> diagnostics;
  return tree_text(parse(source, diagnostics));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Source source("fuzz.rules", std::string(reinterpret_cast<const char*>(data), size));
  const auto once = format(source);
  if (!once) return 0;
  const Source formatted("formatted.rules", *once);
  const auto twice = format(formatted);
  if (!twice || *twice != *once) __builtin_trap();
  if (tree_of(formatted) != tree_of(source)) __builtin_trap();
  return 0;
}
