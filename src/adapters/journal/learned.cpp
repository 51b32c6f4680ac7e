#include "journal/learned.h"

#include <algorithm>
#include <string_view>

namespace culprit::journal {
namespace {

constexpr std::string_view kClears = " clears by itself";
constexpr std::string_view kStays = " stays";

void merge_coincidences(std::vector<LearnedCoincidence>& ours,
                        const std::vector<LearnedCoincidence>& theirs) {
  for (const LearnedCoincidence& each : theirs) {
    const auto known = std::ranges::find_if(ours, [&](const LearnedCoincidence& o) {
      return o.rule == each.rule && o.other == each.other;
    });
    if (known == ours.end()) {
      ours.push_back(each);
    } else {
      known->count = std::min(known->count, Coincidences::kMost - each.count) + each.count;
    }
  }
}

}  // namespace

Belief grown_from(const Belief& prior, const LearnedBelief& learned) {
  return regrown(learned.belief, learned.prior, prior);
}

LearnedLatency named(const std::string& rule, const Latencies::Learned& learned) {
  return {rule, learned.count, seconds(learned.range.least), seconds(learned.range.most)};
}

Latencies::Learned latency_from(const LearnedLatency& learned) {
  const Duration least = from_seconds(learned.least_s);
  return {learned.count, {least, from_seconds(learned.most_s), least}};
}

std::array<LearnedLatency, 2> named(const std::string& rule, const Transients::Seen& seen) {
  const double longest_s = seconds(seen.longest);
  return {{{rule + std::string(kClears), seen.cleared, longest_s, longest_s},
           {rule + std::string(kStays), seen.stayed, 0, 0}}};
}

std::optional<std::pair<std::string, Transients::Seen>> transients_from(
    const LearnedLatency& learned) {
  const auto rule = [&](std::string_view end) {
    return learned.rule.substr(0, learned.rule.size() - end.size());
  };
  if (learned.rule.ends_with(kStays))
    return std::pair(rule(kStays), Transients::Seen{0, learned.count, {}});
  if (!learned.rule.ends_with(kClears)) return std::nullopt;
  return std::pair(rule(kClears), Transients::Seen{learned.count, 0, from_seconds(learned.most_s)});
}

LearnedCoincidence coincidence_of(std::string one, std::string other, int count) {
  if (other < one) std::swap(one, other);
  return {std::move(one), std::move(other), count};
}

std::vector<LearnedCoincidence> named(const Coincidences& coincidences, const Coincidences& before,
                                      const RuleSet& rules) {
  std::vector<LearnedCoincidence> all;
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    const int count = coincidences.times(RuleId(r));
    const std::string& name = rules.rules[r].name;
    if (count != before.times(RuleId(r))) all.push_back({name, name, count});
  }
  for (const auto& [pair, count] : coincidences.pairs()) {
    if (count != before.together(pair.first, pair.second))
      all.push_back(coincidence_of(rules[pair.first].name, rules[pair.second].name, count));
  }
  return all;
}

void merge(Learned& learned, const Learned& other) {
  for (const LearnedBelief& theirs : other.beliefs) {
    const auto ours = std::find_if(
        learned.beliefs.begin(), learned.beliefs.end(), [&](const LearnedBelief& belief) {
          return belief.rule == theirs.rule && belief.strategy == theirs.strategy;
        });
    if (ours == learned.beliefs.end()) {
      learned.beliefs.push_back(theirs);
    } else {
      ours->belief = grown_from(ours->belief, theirs);
    }
  }
  for (const LearnedCoupling& theirs : other.couplings) {
    const auto ours = std::find_if(
        learned.couplings.begin(), learned.couplings.end(), [&](const LearnedCoupling& coupling) {
          return coupling.cause == theirs.cause && coupling.effect == theirs.effect;
        });
    if (ours == learned.couplings.end()) {
      learned.couplings.push_back(theirs);
    } else {
      ours->coupling.cleared += theirs.coupling.cleared;
      ours->coupling.stayed += theirs.coupling.stayed;
      ours->coupling.spared += theirs.coupling.spared;
    }
  }
  for (const LearnedLatency& theirs : other.latencies) {
    if (theirs.count == 0) continue;
    const auto ours =
        std::find_if(learned.latencies.begin(), learned.latencies.end(),
                     [&](const LearnedLatency& latency) { return latency.rule == theirs.rule; });
    if (ours == learned.latencies.end()) {
      learned.latencies.push_back(theirs);
    } else if (ours->count == 0) {
      *ours = theirs;
    } else {
      constexpr int kMost = Latencies::Learned::kMost;
      ours->count = std::min(ours->count, kMost - theirs.count) + theirs.count;
      ours->least_s = std::min(ours->least_s, theirs.least_s);
      ours->most_s = std::max(ours->most_s, theirs.most_s);
    }
  }
  merge_coincidences(learned.coincidences, other.coincidences);
}

}  // namespace culprit::journal
