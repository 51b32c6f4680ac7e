#include "rover_study/study.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "simulation/random.h"
#include "study/ordered_work.h"
#include "study/statistics/holm.h"

namespace culprit::study {
namespace {

using rover::Fault;
using simulation::mix;

constexpr double kStandsWithin = 3;  // seconds
constexpr const char* kPlayLine = "{:<34} {:<8} {:<30} {:>8} {:>8} {:>7} {:>6}\n";
constexpr std::array<const char*, kRoverMetrics> kNames = {"until healed, s", "stood, s", "goals",
                                                           "wrong restarts", "calls for a person"};

std::vector<std::vector<const Fault*>> singles() {
  std::vector<std::vector<const Fault*>> all;
  for (const Fault& fault : rover::faults()) all.push_back({&fault});
  return all;
}

std::vector<std::vector<const Fault*>> pairs() {
  std::vector<std::vector<const Fault*>> all;
  for (const Fault& first : rover::faults()) {
    for (const Fault& second : rover::faults()) {
      if (&first < &second && first.cause != second.cause) all.push_back({&first, &second});
    }
  }
  return all;
}

std::vector<std::vector<const Fault*>> triples(std::uint32_t count, std::uint64_t seed) {
  simulation::Random random(seed);
  const std::vector<Fault>& known = rover::faults();
  std::vector<std::vector<const Fault*>> all;
  while (all.size() < count) {
    std::vector<const Fault*> three;
    while (three.size() < 3) {
      const Fault& fault =
          known[static_cast<std::size_t>(random.below(static_cast<int>(known.size())))];
      const auto is_same = [&](const Fault* each) { return each->cause == fault.cause; };
      if (std::ranges::none_of(three, is_same)) three.push_back(&fault);
    }
    all.push_back(std::move(three));
  }
  return all;
}

// The value that a share `q` of `plays` does not exceed; nothing if fewer are known.
std::optional<double> quantile(std::vector<double> known, int plays, double q) {
  std::ranges::sort(known);
  const auto place = static_cast<std::size_t>(std::ceil(q * plays)) - 1;
  return place < known.size() ? std::optional(known[place]) : std::nullopt;
}

// Wilcoxon's signed-rank test, two-sided, in its normal approximation with a correction for ties. Differences of 0 are left out.
double signed_rank_test(std::vector<double> differences) {
  std::erase(differences, 0.0);
  std::ranges::sort(differences, {}, [](double d) { return std::abs(d); });
  double positive = 0;
  double variance = 0;
  for (std::size_t i = 0; i < differences.size();) {
    std::size_t end = i;
    while (end < differences.size() && std::abs(differences[end]) - std::abs(differences[i]) < 1e-9)
      ++end;
    const double rank = static_cast<double>(i + 1 + end) / 2;
    for (; i < end; ++i) {
      positive += differences[i] > 0 ? rank : 0;
      variance += rank * rank / 4;
    }
  }
  const auto n = static_cast<double>(differences.size());
  if (n == 0) return 1;
  const double z = (positive - n * (n + 1) / 4) / std::sqrt(variance);
  return std::erfc(std::abs(z) / std::sqrt(2));
}

std::string seconds_or_dash(const std::optional<double>& value) {
  return value ? fmt::format("{:.1f} s", *value) : "–";
}

// The first column is to the left, all others to the right.
Table table_with(std::string id, std::string caption, const std::vector<const char*>& titles) {
  Table table;
  table.id = std::move(id);
  table.caption = std::move(caption);
  for (const char* title : titles) table.columns.push_back({.title = title});
  table.columns.front().align = Align::kLeft;
  return table;
}

bool stands_in_time(const RoverResult& result) {
  return result.stands_after_s && *result.stands_after_s <= kStandsWithin;
}

}  // namespace

std::vector<rover::Play> plays_of(const RoverCampaign& campaign) {
  using enum RoverCampaign::Faults;
  const auto all = campaign.faults == kSingle  ? singles()
                   : campaign.faults == kPairs ? pairs()
                                               : triples(campaign.triples, campaign.seed);
  std::vector<rover::Play> plays;
  for (const auto& faults : all)
    plays.push_back(rover::play_of(faults, mix(campaign.seed + mix(plays.size()))));
  return plays;
}

RoverResults play_all(const RuleSet& rules, const std::vector<rover::Play>& plays,
                      const RoverCampaign& campaign) {
  RoverResults results(campaign.managers.size());
  const std::size_t count = plays.size();
  work_in_order(
      0, count * results.size(), campaign.jobs,
      [&](std::uint64_t i) { return play(rules, plays[i % count], campaign.managers[i / count]); },
      [&](std::uint64_t i, RoverResult result) {
        results[i / count].push_back(std::move(result));
        return true;
      });
  return results;
}

double value_of(RoverMetric metric, const RoverResult& result) {
  switch (metric) {
    case RoverMetric::kHealed_s:
      return result.healed_s.value_or(seconds(RoverTimes::kPatience));
    case RoverMetric::kStood_s:
      return result.stood_s;
    case RoverMetric::kGoals:
      return result.goals;
    case RoverMetric::kWrongRestarts:
      return result.wrong_restarts;
    case RoverMetric::kCalls:
      return result.calls;
  }
  return 0;
}

RoverRow row_of(const std::string& manager, const std::vector<rover::Play>& plays,
                const std::vector<RoverResult>& results) {
  RoverRow row{.manager = manager};
  std::vector<double> healed_s;
  for (std::size_t i = 0; i < plays.size(); ++i) {
    const RoverResult& result = results[i];
    row.wrong_restarts += result.wrong_restarts;
    if (result.collisions) row.collisions = row.collisions.value_or(0) + *result.collisions;
    if (!plays[i].is_fixable()) {
      ++row.unfixable;
      row.stands += stands_in_time(result) ? 1 : 0;
      continue;
    }
    ++row.plays;
    row.faults += static_cast<int>(plays[i].faults.size());
    row.blamed += result.blamed;
    row.calls += result.calls;
    row.stood_s.add(result.stood_s);
    row.goals_an_hour.add(result.goals * 3600 / result.watched_s);
    if (result.healed_s) healed_s.push_back(*result.healed_s);
  }
  row.healed = static_cast<int>(healed_s.size());
  row.median_s = quantile(healed_s, row.plays, 0.5);
  row.late_s = quantile(healed_s, row.plays, 0.95);
  return row;
}

std::vector<RoverComparison> compare(const std::vector<rover::Play>& plays,
                                     const std::vector<RoverResult>& first,
                                     const std::vector<RoverResult>& second) {
  std::vector<RoverComparison> all;
  std::vector<double> ps;
  for (std::size_t m = 0; m < kRoverMetrics; ++m) {
    const auto metric = static_cast<RoverMetric>(m);
    const double sign = metric == RoverMetric::kGoals ? -1 : 1;
    Moments ours;
    Moments theirs;
    std::vector<double> differences;
    RoverComparison comparison{.metric = metric};
    for (std::size_t i = 0; i < plays.size(); ++i) {
      if (!plays[i].is_fixable()) continue;
      const double a = value_of(metric, first[i]);
      const double b = value_of(metric, second[i]);
      ours.add(a);
      theirs.add(b);
      differences.push_back(a - b);
      if (sign * a < sign * b) ++comparison.better;
      if (sign * a > sign * b) ++comparison.worse;
    }
    comparison.first = ours.mean();
    comparison.second = theirs.mean();
    ps.push_back(signed_rank_test(std::move(differences)));
    all.push_back(comparison);
  }
  const std::vector<double> corrected = holm(ps);
  for (std::size_t m = 0; m < kRoverMetrics; ++m) all[m].p = corrected[m];
  return all;
}

Table table_of(const std::vector<RoverRow>& rows) {
  Table table = table_with("rover", "Faults of the rover, by manager",
                           {"manager", "healed", "median", "95 %", "stood", "goals an hour",
                            "wrong restarts", "blamed right", "calls", "stands within 3 s"});
  const bool is_live = !rows.empty() && rows.front().collisions;
  if (is_live) table.columns.push_back({.title = "collisions"});
  for (const RoverRow& row : rows) {
    table.rows.push_back({{row.manager},
                          {fmt::format("{} of {}", row.healed, row.plays)},
                          {seconds_or_dash(row.median_s)},
                          {seconds_or_dash(row.late_s)},
                          {fmt::format("{:.1f} s", row.stood_s.mean())},
                          {fmt::format("{:.0f}", row.goals_an_hour.mean())},
                          {fmt::format("{}", row.wrong_restarts)},
                          {fmt::format("{} of {}", row.blamed, row.faults)},
                          {fmt::format("{}", row.calls)},
                          {fmt::format("{} of {}", row.stands, row.unfixable)}});
    if (is_live) table.rows.back().push_back({fmt::format("{}", row.collisions.value_or(0))});
  }
  return table;
}

Table comparisons_of(const std::string& name, const RoverCampaign& campaign,
                     const std::vector<rover::Play>& plays, const RoverResults& results) {
  const auto& managers = campaign.managers;
  Table table =
      table_with("rover-comparisons", name + " against the others",
                 {"against", "metric", name.c_str(), "other", "plays better", "worse", "p"});
  const auto found = std::ranges::find(managers, name);
  if (found == managers.end()) return table;
  const auto& ours = results[static_cast<std::size_t>(found - managers.begin())];
  for (std::size_t m = 0; m < managers.size(); ++m) {
    if (managers[m] == name) continue;
    for (const RoverComparison& each : compare(plays, ours, results[m]))
      table.rows.push_back({{managers[m]},
                            {kNames[static_cast<std::size_t>(each.metric)]},
                            {fmt::format("{:.2f}", each.first)},
                            {fmt::format("{:.2f}", each.second)},
                            {fmt::format("{}", each.better)},
                            {fmt::format("{}", each.worse)},
                            {each.p < 0.001 ? "< 0.001" : fmt::format("{:.3f}", each.p)}});
  }
  return table;
}

std::string left_of(const std::string& manager, const std::vector<rover::Play>& plays,
                    const std::vector<RoverResult>& results) {
  std::string text;
  for (std::size_t i = 0; i < plays.size(); ++i) {
    const RoverResult& result = results[i];
    const bool is_fixable = plays[i].is_fixable();
    if (is_fixable && result.healed_s) continue;
    if (!is_fixable && stands_in_time(result)) continue;
    text += fmt::format("{}: {} {}: {}\n", manager, plays[i].name,
                        is_fixable ? "did not heal" : "did not stand within 3 s",
                        result.complaint.empty() ? "a failure is open" : result.complaint);
  }
  return text;
}

std::string header_of_plays() {
  return fmt::format(kPlayLine, "fault", "noticed", "blamed", "healed", "stood", "others", "goals");
}

std::string line_of(const rover::Play& play, const RoverResult& result) {
  const auto right = std::ranges::find_if(
      result.names, [&](const std::string& name) { return play.is_cause(name); });
  std::string blamed = right != result.names.end() ? *right : "none";
  if (right == result.names.end() && !result.names.empty())
    blamed = "not it: " + result.names.front();
  std::string healed = result.healed_s ? seconds_or_dash(result.healed_s) : "no";
  if (!play.is_fixable()) healed = result.stands_after_s ? "stops" : "drives";
  return fmt::format(kPlayLine, play.name, result.is_noticed ? "yes" : "no", blamed, healed,
                     seconds_or_dash(result.stood_s), result.wrong_restarts, result.goals);
}

}  // namespace culprit::study
