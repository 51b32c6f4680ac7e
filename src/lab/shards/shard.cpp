#include "shards/shard.h"

#include <algorithm>
#include <charconv>

namespace culprit::study {
namespace {

// 0 of what is no number.
std::uint32_t natural(std::string_view text) {
  std::uint32_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end ? value : 0;
}

}  // namespace

Expected<Shard> parse_shard(std::string_view text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const std::uint32_t number = natural(text.substr(0, slash));
  const std::uint32_t count = natural(text.substr(std::min(slash + 1, text.size())));
  if (number < 1 || number > count || count > kMostShards) {
    return Error{"'" + std::string(text) + "' is no shard; write i/n with 1 <= i <= n <= " +
                 std::to_string(kMostShards) + ", as in 2/4"};
  }
  return Shard{number, count};
}

std::string label(const Shard& shard) {
  return std::to_string(shard.number) + "/" + std::to_string(shard.count);
}

}  // namespace culprit::study
