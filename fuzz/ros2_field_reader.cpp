// Paths into messages, and the payloads that they are read from. The first byte says which type,
// the second how long the path is; then come path and payload.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ros2/field_reader.h"
#include "ros2/standard_messages.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace culprit;
  using namespace culprit::ros2;
  static MessageLibrary library;
  if (size < 2) return 0;
  const auto types = standard_messages();
  const std::string_view type = types[data[0] % types.size()].type;
  const std::size_t length = std::min<std::size_t>(data[1], size - 2);
  const std::string_view path(reinterpret_cast<const char*>(data + 2), length);
  const auto reader = FieldReader::compile(library, type, path);
  if (!reader) return 0;
  Value value;
  reader->read(rtps::ByteView(data + 2 + length, size - 2 - length), value);
  return 0;
}
