// A part of a campaign that one process works off: the i-th of n takes each n-th run.
//
// Neighbouring runs go to different shards, so that slow configurations are shared by all; and what
// the shards found can be folded in the campaign's order by taking one run of each in turn.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/expected.h"

namespace culprit::study {

struct Shard {
  std::uint32_t number = 1;  // 1..count
  std::uint32_t count = 1;

  bool operator==(const Shard&) const = default;
};

inline constexpr std::uint32_t kMostShards = 100'000;

// Reads "2/4".
Expected<Shard> parse_shard(std::string_view text);

std::string label(const Shard& shard);  // "2/4"

// How many of the campaign's runs the shard has.
template <class Campaign>
std::uint64_t size(const Shard& shard, const Campaign& campaign) {
  return (campaign.size() + shard.count - shard.number) / shard.count;
}

// The place in the campaign of the shard's i-th run, from 0. @pre i < size(shard, campaign)
inline std::uint64_t campaign_index(const Shard& shard, std::uint64_t i) {
  return i * shard.count + (shard.number - 1);
}

}  // namespace culprit::study
