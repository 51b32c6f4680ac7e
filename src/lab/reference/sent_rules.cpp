#include "reference/sent_rules.h"

#include <algorithm>
#include <random>

namespace culprit::study::reference {

SentRules::SentRules(std::size_t rules, std::uint64_t seed) {
  constexpr std::size_t kBuckets = 13;
  std::mt19937_64 random(seed);
  for (std::size_t rule = 0; rule < rules; ++rule)
    buckets_.push_back(seed == 0 ? rule : random() % kBuckets);
}

void SentRules::insert(RuleId rule) {
  const auto neighbour = std::find_if(order_.begin(), order_.end(), [&](RuleId other) {
    return buckets_[other.index] == buckets_[rule.index];
  });
  order_.insert(neighbour == order_.end() ? order_.begin() : neighbour, rule);
}

void SentRules::erase(RuleId rule) { std::erase(order_, rule); }

}  // namespace culprit::study::reference
