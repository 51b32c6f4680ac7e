#include "analyze/lateness_watch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace culprit {
namespace {

using namespace std::chrono_literals;

constexpr double kPassing_s = 0.5;        // along one edge
constexpr double kPassingVaries_s = 0.4;  // standard deviation
constexpr double kPasses = 0.85;          // the probability that a consumer fails, too
constexpr double kUnrelated_per_s = 0.05;
constexpr Duration kFresh = 4s;
// A topic with more consumers, or several producers, is infrastructure (/tf) or redundant: that its consumers
// are well says nothing.
constexpr std::size_t kMostConsumers = 5;

// The difference of two detections.
struct Apart {
  double deviation;

  explicit Apart(double most_s)
      : deviation(std::sqrt(kPassingVaries_s * kPassingVaries_s + most_s * most_s / 6)) {}
  double density(double s) const {
    const double z = (s - kPassing_s) / deviation;
    return std::exp(-z * z / 2) / (deviation * std::sqrt(2 * std::numbers::pi));
  }
  double is_quiet_after(double s) const {
    return 1 - kPasses * std::erfc((kPassing_s - s) / (deviation * std::numbers::sqrt2)) / 2;
  }
};

}  // namespace

LatenessWatch::LatenessWatch(const Knowledge& knowledge, Latencies& latencies)
    : knowledge_(knowledge), latencies_(latencies) {}

bool LatenessWatch::is_fresh(RuleId failure, Time now) const {
  const RuleState& state = knowledge_.states[failure];
  return latencies_.is_late(failure) && !latencies_.is_learned(failure) &&
         state.search.attempts == 0 && state.recurring_since == kNever &&
         now < later(state.failing_since, kFresh);
}

double LatenessWatch::weight(RuleId cause, RuleId effect, Time now) const {
  const double most =
      seconds(std::max(latencies_.lateness(cause).most, latencies_.lateness(effect).most));
  const Apart stated(most);
  const Apart slow(std::max(most, seconds(Latencies::kSlowMonitor)));
  const Time began = knowledge_.states[cause].failing_since;
  const RuleState& state = knowledge_.states[effect];
  if (knowledge_.states.is_active(effect)) {
    const double apart = seconds(state.failing_since - began);
    return std::log((kUnrelated_per_s + slow.density(apart)) /
                    (kUnrelated_per_s + stated.density(apart)));
  }
  if (state.phase != RulePhase::kQuiet || !state.detection.trigger.known) return 0;
  const double since = seconds(now - began);
  const auto still_quiet = [&](const Apart& a) {
    return a.is_quiet_after(since) / a.is_quiet_after(0);
  };
  return std::log(still_quiet(slow) / still_quiet(stated));
}

void LatenessWatch::advance(Time now) {
  const auto& active = knowledge_.states.active();
  const bool is_any_fresh =
      latencies_.statement() != Latencies::Statement::kExceeded &&
      std::ranges::any_of(active, [&](RuleId rule) { return is_fresh(rule, now); });
  const bool is_any_touched = std::ranges::any_of(
      active, [&](RuleId rule) { return knowledge_.states[rule].attempt.has_value(); });
  if (!is_any_fresh || is_any_touched) return;
  std::vector<std::vector<RuleId>> rules_at(knowledge_.graph.size());
  for (std::size_t r = 0; r < knowledge_.rules.rules.size(); ++r) {
    if (!latencies_.is_late(RuleId(r))) continue;
    for (const ComponentId c : knowledge_.rules[RuleId(r)].components) {
      if (const auto vertex = knowledge_.graph.vertex_of(c)) rules_at[*vertex].emplace_back(r);
    }
  }
  double sum = 0;
  knowledge_.graph.for_each_channel([&](auto producers, auto consumers) {
    if (producers.size() > 1 || consumers.size() > kMostConsumers) return;
    for (const auto producer : producers) {
      for (const RuleId cause : rules_at[producer]) {
        if (!knowledge_.states.is_active(cause) || !is_fresh(cause, now)) continue;
        for (const auto consumer : consumers) {
          if (consumer == producer) continue;
          for (const RuleId effect : rules_at[consumer]) sum += weight(cause, effect, now);
        }
      }
    }
  });
  latencies_.weigh(sum);
}

}  // namespace culprit
