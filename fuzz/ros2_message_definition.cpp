// Text of a .msg file: it is read, written and read again, or refused with a message that names its
// line.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "base/name_grammar.h"
#include "ros2/message_definition.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace culprit;
  using namespace culprit::ros2;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto definition = parse_message_definition(text, "a/msg/B", "B.msg");
  if (!definition) {
    if (!definition.error().starts_with("B.msg:")) std::abort();
    return 0;
  }
  for (const FieldDefinition& field : definition->fields) {
    const auto* nested = std::get_if<std::string>(&field.element);
    if (nested != nullptr && !is_valid_type_name(*nested)) std::abort();
    if (field.count == 0 && field.shape != Shape::kSequence) std::abort();
  }
  // The written definition must equal the one that was read.
  const std::string written = to_text("a/msg/B", {{"a/msg/B", *definition}});
  const auto again = parse_message_definition(written, "a/msg/B", "B.msg");
  if (!again || *again != *definition) std::abort();
  return 0;
}
