// Files of the reference's dialects: what is imported passes a check, whatever the file says.
#include <cstddef>
#include <cstdint>
#include <string>

#include "import/importer.h"
#include "language/checker.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace culprit;
  const Source source("fuzz.txt", std::string(reinterpret_cast<const char*>(data), size));
  const auto imported = foreign::import_rules(source);
  if (!imported) {
    if (imported.error().empty()) __builtin_trap();
  } else if (!check(Source("imported.rules", imported->text)).rules) {
    __builtin_trap();
  }
  return 0;
}
