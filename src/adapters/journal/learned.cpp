#include "journal/learned.h"

#include <algorithm>
#include <string_view>

namespace culprit::journal {
namespace {

constexpr std::string_view kClears = " clears by itself";
constexpr std::string_view kStays = " stays";

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
}

}  // namespace culprit::journal
