#include "rtps/cdr.h"

#include "base/invariant.h"

namespace culprit::rtps {

// The two numberings of XCDR2 are those of RTPS 2.5 and of DDS-XTypes 1.3; each is even for big endian.
CdrReader::CdrReader(ByteView payload) {
  if (payload.size() < kEncapsulationSize || payload[0] != 0) return;
  switch (payload[1] & ~1u) {
    case 0x00:
      break;
    case 0x06:
    case 0x10:
      form_ = Form::kPlain2;
      break;
    case 0x08:
    case 0x14:
      form_ = Form::kDelimited2;
      break;
    case 0x0a:
    case 0x12:
      form_ = Form::kMembers2;
      break;
    default:
      return;
  }
  endianness_ = static_cast<Endianness>(payload[1] & 1u);
  body_ = payload.subspan(kEncapsulationSize);
  ok_ = true;
}

// The length of a field stands in the header, behind it, or is the first four bytes of the field (DDS-XTypes 1.3, 7.4.3.4.2).
void CdrReader::enter_field() {
  if (form_ != Form::kMembers2) return;
  constexpr std::uint32_t kLengthFollows = 4;
  const auto header = read<std::uint32_t>();
  if ((header >> 28 & 7) == kLengthFollows) read<std::uint32_t>();
}

bool CdrReader::align(std::size_t size) {
  constexpr std::size_t kMost2 = 4;
  if (is_xcdr2() && size > kMost2) size = kMost2;
  CULPRIT_ASSERT(size > 0);
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
  CULPRIT_ASSERT(smallest_element > 0);
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

}  // namespace culprit::rtps
