#include "ros2/service_mapping.h"

#include <algorithm>
#include <utility>

namespace culprit::ros2 {
namespace {

constexpr std::size_t kHeaderSize = 16;

}  // namespace

Mapping mapping_of(const ParticipantInfo* participant) {
  return participant != nullptr && participant->vendor == Vendor::kCyclone ? Mapping::kHeader
                                                                           : Mapping::kInline;
}

rtps::Bytes with_header(rtps::ByteView payload, const ServiceHeader& header) {
  const auto body = std::min(rtps::kEncapsulationSize, payload.size());
  rtps::CdrWriter writer(payload.size() > 1 && payload[1] == 0 ? rtps::Endianness::kBig
                                                               : rtps::Endianness::kLittle);
  writer.write(header.client);
  writer.write(header.sequence);
  writer.write_bytes(payload.subspan(body));
  return writer.take();
}

std::optional<SplitPayload> split_header(rtps::ByteView payload) {
  rtps::CdrReader reader(payload);
  SplitPayload split;
  split.header.client = reader.read<std::uint64_t>();
  split.header.sequence = reader.read<std::int64_t>();
  if (!reader.ok()) return std::nullopt;
  split.payload.assign(payload.begin(), payload.begin() + rtps::kEncapsulationSize);
  split.payload.insert(split.payload.end(),
                       payload.begin() + rtps::kEncapsulationSize + kHeaderSize, payload.end());
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

std::vector<rtps::GuidPrefix> servers_among(
    const Matches& request_readers, const Matches& reply_writers,
    const std::function<std::string_view(const rtps::Guid&)>& id_of) {
  struct Newest {
    std::uint64_t reader = 0;
    std::uint64_t writer = 0;
  };
  std::map<std::pair<rtps::GuidPrefix, std::string_view>, Newest> servers;
  const auto add = [&](const Matches& endpoints, std::uint64_t Newest::*which) {
    for (const auto& [endpoint, number] : endpoints) {
      std::uint64_t& newest = servers[{endpoint.prefix(), id_of(endpoint)}].*which;
      newest = std::max(newest, number);
    }
  };
  add(request_readers, &Newest::reader);
  add(reply_writers, &Newest::writer);
  std::map<std::uint64_t, rtps::GuidPrefix> by_age;
  for (const auto& [server, newest] : servers) {
    if (newest.reader != 0 && newest.writer != 0)
      by_age[std::max(newest.reader, newest.writer)] = server.first;
  }
  std::vector<rtps::GuidPrefix> all;
  for (const auto& [age, participant] : by_age) all.push_back(participant);
  return all;
}

}  // namespace culprit::ros2
