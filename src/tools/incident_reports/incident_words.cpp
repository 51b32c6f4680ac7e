#include "incident_reports/incident_words.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "knowledge/describe.h"

namespace culprit::incident_reports {

std::string cause_of(const Incident& incident) {
  if (!incident.causes.empty()) return listed(incident.causes);
  return incident.rules.empty() ? "unknown" : incident.rules.front();
}

std::string outcome_of(const Incident& incident) {
  if (incident.is_given_up) return "exhausted: a person must look";
  if (!incident.is_over) return "not over";
  if (!incident.merged_into.empty()) return "part of " + incident.merged_into;
  if (incident.is_lost) return "can no longer be evaluated";
  if (incident.is_cut) return "unknown: culprit ended before";
  return incident.helped.empty() ? "cleared without a repair" : listed(incident.helped);
}

std::string lasting_text(double seconds) {
  constexpr double kTenthsBelow = 9.95;  // s
  if (seconds > 0 && seconds < 0.0995)
    return fmt::format("{:.0f} ms", std::max(1.0, std::round(1000 * seconds)));
  if (seconds < kTenthsBelow) return fmt::format("{:.1f} s", std::max(0.0, seconds));
  const auto whole = static_cast<std::int64_t>(std::round(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  if (whole < 86'400) return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
  return fmt::format("{} d {} h", whole / 86'400, whole % 86'400 / 3600);
}

}  // namespace culprit::incident_reports
