#include "ros2/service_mapping.h"

#include <algorithm>

namespace culprit::ros2 {
namespace {

constexpr std::size_t kHeaderSize = 16;

}  // namespace

Mapping mapping_of(const ParticipantInfo* participant) {
  return participant != nullptr && participant->vendor == Vendor::kCyclone ? Mapping::kHeader
                                                                           : Mapping::kInline;
}

Bytes with_header(ByteView payload, const ServiceHeader& header) {
  const auto body = std::min(kEncapsulationSize, payload.size());
  CdrWriter writer(payload.size() > 1 && payload[1] == 0 ? Endianness::kBig : Endianness::kLittle);
  writer.write(header.client);
  writer.write(header.sequence);
  writer.write_bytes(payload.subspan(body));
  return writer.take();
}

std::optional<SplitPayload> split_header(ByteView payload) {
  CdrReader reader(payload);
  SplitPayload split;
  split.header.client = reader.read<std::uint64_t>();
  split.header.sequence = reader.read<std::int64_t>();
  if (!reader.ok()) return std::nullopt;
  split.payload.assign(payload.begin(), payload.begin() + kEncapsulationSize);
  split.payload.insert(split.payload.end(), payload.begin() + kEncapsulationSize + kHeaderSize,
                       payload.end());
  return split;
}

std::string_view user_data_value(std::string_view user_data, std::string_view key) {
  while (!user_data.empty()) {
    const auto end = std::min(user_data.find(';'), user_data.size());
    const auto pair = user_data.substr(0, end);
    if (pair.size() > key.size() && pair.starts_with(key) && pair[key.size()] == '=') {
      return pair.substr(key.size() + 1);
    }
    user_data.remove_prefix(std::min(end + 1, user_data.size()));
  }
  return {};
}

}  // namespace culprit::ros2
