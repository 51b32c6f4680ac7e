#include "study/sealed_line.h"

#include <boost/crc.hpp>
#include <fmt/core.h>

namespace culprit::study {
namespace {

std::string seal(std::string_view body) {
  boost::crc_32_type crc;
  crc.process_bytes(body.data(), body.size());
  return fmt::format(",\"check\":\"{:08x}\"}}", crc.checksum());
}

const std::size_t kSealSize = seal("").size();

}  // namespace

std::string sealed_line(const Json& json) {
  // Numbers are written with as few digits as bring them back to the last bit.
  const std::string body = to_line(json);
  return body.substr(0, body.size() - 1) + seal(body) + "\n";
}

std::optional<Json> unsealed(std::string_view line) {
  if (line.size() <= kSealSize) return std::nullopt;
  const std::string body = std::string(line.substr(0, line.size() - kSealSize)) + "}";
  if (seal(body) != line.substr(line.size() - kSealSize)) return std::nullopt;
  Json json = parse_json(body);
  if (!json.is_object()) return std::nullopt;
  return json;
}

}  // namespace culprit::study
