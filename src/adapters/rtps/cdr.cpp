#include "rtps/cdr.h"

namespace culprit::ros2 {

CdrReader::CdrReader(ByteView payload) {
  if (payload.size() < kEncapsulationSize || payload[0] != 0 || payload[1] > 1) return;
  endianness_ = static_cast<Endianness>(payload[1]);
  body_ = payload.subspan(kEncapsulationSize);
  ok_ = true;
}

bool CdrReader::align(std::size_t size) {
  const std::size_t aligned = (at_ + size - 1) / size * size;
  if (!ok_ || aligned > body_.size()) return false;
  at_ = aligned;
  return true;
}

std::string_view CdrReader::read_string() {
  const auto size = read<std::uint32_t>();
  const ByteView bytes = read_bytes(size);
  if (bytes.empty()) return {};  // also a string without even its NUL, which some peers send
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.back() == '\0' ? text.substr(0, text.size() - 1) : text;
}

std::uint32_t CdrReader::read_count(std::size_t smallest_element) {
  const auto count = read<std::uint32_t>();
  if (left() / smallest_element >= count) return count;
  fail();
  return 0;
}

ByteView CdrReader::read_bytes(std::size_t count) {
  if (left() < count) {
    fail();
    return {};
  }
  const ByteView bytes = body_.subspan(at_, count);
  at_ += count;
  return bytes;
}

void CdrReader::skip(std::size_t size, std::uint64_t count) {
  if (count == 0) return;
  if (!align(size) || left() / size < count) return fail();
  at_ += size * static_cast<std::size_t>(count);
}

CdrWriter::CdrWriter(Endianness endianness)
    : bytes_{0, static_cast<std::uint8_t>(endianness), 0, 0}, endianness_(endianness) {}

void CdrWriter::write_string(std::string_view text) {
  write(static_cast<std::uint32_t>(text.size() + 1));
  bytes_.insert(bytes_.end(), text.begin(), text.end());
  bytes_.push_back(0);
}

void CdrWriter::write_bytes(ByteView bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

}  // namespace culprit::ros2
