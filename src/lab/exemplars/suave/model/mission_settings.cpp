#include "exemplars/suave/model/mission_settings.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "base/joined.h"
#include "exemplars/suave/model/vehicle.h"
#include "simulation/random.h"

namespace culprit::suave::model {
namespace {

constexpr double kMostSeconds = 100'000;

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_whole = error == std::errc() && end == text.data() + text.size();
  return is_whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

// The shortest text that is read as the same number.
std::string plain(double value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return {text, end};
}

// Draws a value for run number `run`. Does not advance the random numbers for a constant, so that
// constants change no run.
double draw(const Range& range, std::uint32_t run, simulation::Random& random) {
  if (!range.turns.empty()) return range.turns[run % range.turns.size()];
  return range.low == range.high ? range.low : random.uniform(range.low, range.high);
}

bool is_within(const Range& range, double least, double most) {
  return least <= range.low && range.low <= range.high && range.high <= most &&
         std::all_of(range.turns.begin(), range.turns.end(),
                     [&](double each) { return least <= each && each <= most; });
}

}  // namespace

MissionSettings settings_of(const MissionPlan& plan) {
  MissionSettings settings;
  settings.visibility_period_s = plan.visibility_period_s;
  settings.visibility_shift_s = {plan.visibility_shift_s, plan.visibility_shift_s};
  settings.least_visibility_m = plan.least_visibility_m;
  settings.most_visibility_m = plan.most_visibility_m;
  for (const ThrusterEvent& event : plan.thruster_events) {
    const double at = seconds(event.at);
    settings.thruster_events.push_back({event.thruster, event.fails, {at, at}});
  }
  if (plan.start_y_m) settings.start_y_m = Range{*plan.start_y_m, *plan.start_y_m};
  settings.time_limit_s = seconds(plan.time_limit);
  return settings;
}

MissionPlan drawn(const MissionPlan& plan, const MissionSettings& settings, std::uint64_t seed,
                  std::uint32_t run) {
  simulation::Random random(simulation::mix(seed) ^ 0x5e77165);
  MissionPlan of_run = plan;
  of_run.visibility_period_s = settings.visibility_period_s;
  of_run.visibility_shift_s = draw(settings.visibility_shift_s, run, random);
  of_run.least_visibility_m = settings.least_visibility_m;
  of_run.most_visibility_m = settings.most_visibility_m;
  of_run.time_limit = from_seconds(settings.time_limit_s);
  of_run.start_y_m.reset();
  if (settings.start_y_m) of_run.start_y_m = draw(*settings.start_y_m, run, random);
  of_run.thruster_events.clear();
  for (const ThrusterSetting& event : settings.thruster_events) {
    // The exemplar waits until as many whole seconds are over.
    const double at = std::ceil(draw(event.at_s, run, random));
    of_run.thruster_events.push_back({event.thruster, event.fails, from_seconds(at)});
  }
  std::stable_sort(of_run.thruster_events.begin(), of_run.thruster_events.end(),
                   [](const ThrusterEvent& a, const ThrusterEvent& b) { return a.at < b.at; });
  return of_run;
}

Expected<void> check(const MissionSettings& settings) {
  constexpr double kFar = 1000;  // m
  if (!is_within({settings.visibility_period_s, settings.visibility_period_s}, 1, kMostSeconds))
    return Error{"the visibility's period must be 1 to 100000 s"};
  if (!is_within(settings.visibility_shift_s, 0, kMostSeconds))
    return Error{"the visibility's shift must be 0 to 100000 s, the lower end first"};
  if (!is_within({settings.least_visibility_m, settings.most_visibility_m}, 0, kFar))
    return Error{"the visibility must be 0 to 1000 m, the lower end first"};
  if (!is_within({settings.time_limit_s, settings.time_limit_s}, 1, kMostSeconds))
    return Error{"the time limit must be 1 to 100000 s"};
  if (settings.start_y_m && !is_within(*settings.start_y_m, -kFar, kFar))
    return Error{"the start must be -1000 to 1000 m, the lower end first"};
  for (const ThrusterSetting& event : settings.thruster_events) {
    if (event.thruster < 1 || event.thruster > kThrusters)
      return Error{"there is no thruster " + std::to_string(event.thruster) + "; they are 1 to " +
                   std::to_string(kThrusters)};
    if (!is_within(event.at_s, 0, kMostSeconds))
      return Error{"a thruster's event must be at 0 to 100000 s, the lower end first"};
  }
  return {};
}

Expected<Range> parse_range(std::string_view text) {
  const Error error{"'" + std::string(text) +
                    "' is neither a number (35), a range (0..120), nor some by turns (35,60)"};
  if (text.find(',') != std::string_view::npos) {
    Range range;
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t comma = std::min(text.find(',', begin), text.size());
      const auto number = parse_number(text.substr(begin, comma - begin));
      if (!number) return error;
      range.turns.push_back(*number);
      begin = comma + 1;
    }
    return range;
  }
  const std::size_t dots = text.find("..");
  const auto low = parse_number(text.substr(0, dots));
  const auto high = dots == std::string_view::npos ? low : parse_number(text.substr(dots + 2));
  if (low && high) return Range{*low, *high};
  return error;
}

Expected<ThrusterSetting> parse_thruster(std::string_view text) {
  const Error error{"'" + std::string(text) +
                    "' is no thruster's event; write 1:fails@35 or 3:recovers@0..200"};
  const std::size_t colon = text.find(':');
  const std::size_t at = text.find('@');
  if (colon == std::string_view::npos || at == std::string_view::npos || at < colon) return error;
  const auto thruster = parse_number(text.substr(0, colon));
  const std::string_view what = text.substr(colon + 1, at - colon - 1);
  const auto when = parse_range(text.substr(at + 1));
  if (!thruster || *thruster < 1 || *thruster > kThrusters || *thruster != std::floor(*thruster) ||
      !when || (what != "fails" && what != "recovers"))
    return error;
  return ThrusterSetting{static_cast<int>(*thruster), what == "fails", *when};
}

std::string to_string(const Range& range) {
  if (!range.turns.empty()) return joined(range.turns, ",", plain);
  return range.low == range.high ? plain(range.low) : plain(range.low) + ".." + plain(range.high);
}

std::string to_string(const ThrusterSetting& event) {
  return std::to_string(event.thruster) + (event.fails ? ":fails@" : ":recovers@") +
         to_string(event.at_s);
}

}  // namespace culprit::suave::model
