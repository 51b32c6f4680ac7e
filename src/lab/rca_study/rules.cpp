#include "rca_study/rules.h"

#include <cmath>

#include <fmt/core.h>

#include "base/log_gamma.h"
#include "language/checker.h"

namespace culprit::study::rca {
namespace {

// The probability that at least `needed` of `window` readings are wrong.
double tail(int needed, int window, double wrong) {
  double sum = 0;
  for (int k = needed; k <= window; ++k) {
    sum += std::exp(log_gamma(window + 1) - log_gamma(k + 1) - log_gamma(window - k + 1)) *
           std::pow(wrong, k) * std::pow(1 - wrong, window - k);
  }
  return sum;
}

// The shortest window with a false detection in less than a million evaluations. It may miss so
// many readings that a false recovery is rarer than one in a hundred thousand.
std::string hold(const Detector& detector) {
  constexpr double kRareAlarm = 1e-6;
  constexpr double kRareMiss = 1e-5;
  constexpr int kLongest = 30;
  if (detector.false_alarm <= 0 && detector.miss <= 0) return "";
  int missed = 0;
  while (missed < kLongest / 3 && std::pow(detector.miss, missed + 1) >= kRareMiss) ++missed;
  int window = missed + 1;
  while (window < kLongest && tail(window - missed, window, detector.false_alarm) >= kRareAlarm)
    ++window;
  return fmt::format(" HOLD {}/{}", window - missed, window);
}

const char* level(Criticality criticality) {
  switch (criticality) {
    case Criticality::kNonCritical:
      return "NON_CRITICAL";
    case Criticality::kWarning:
      return "WARNING";
    case Criticality::kError:
      break;
  }
  return "ERROR";
}

std::string adaptation(const std::string& component, const Treatment& treatment) {
  switch (treatment.repair) {
    case Repair::kConfigure:
      return fmt::format("{} set_parameter tuning 1.0 {}", component, treatment.impact);
    case Repair::kRestart:
      return fmt::format("{} restart {}", component, treatment.impact);
    case Repair::kRedeploy:
      break;
  }
  return fmt::format("{} redeploy {}", component, treatment.impact);
}

}  // namespace

std::string rules_text(const RcaScenario& scenario) {
  std::string text = "ROBOT benchmark\nCYCLE 200ms\n\n";
  for (const RcaTopic& topic : scenario.topics) {
    if (topic.is_ignored) text += fmt::format("IGNORE TOPIC {}\n", topic.name);
  }
  for (const RcaComponent& c : scenario.components) {
    text += fmt::format("COMPONENT {0} NODE /{0} LAUNCH \"run {0}\"\n", c.name);
    if (!c.is_unwatched) text += fmt::format("SIGNAL {0}_ill DIAGNOSTIC {0} KEY ill\n", c.name);
  }
  for (const RcaComponent& c : scenario.components) {
    if (c.is_unwatched) continue;
    text +=
        fmt::format("\nRULE {0}_fails\n  POLICIES {1}{2} ATTEMPTS 12\n  TRIGGER {0}_ill == true\n",
                    c.name, level(c.criticality), hold(c.detector));
    for (const Treatment& t : c.treatments)
      text += fmt::format("    STRATEGY {} {:g} {:g}\n      ADAPTATION {}\n", to_string(t.repair),
                          t.success, t.confidence, adaptation(c.name, t));
  }
  return text;
}

RuleSet rules_of(const RcaScenario& scenario) {
  return *check(Source("scenario.rules", rules_text(scenario))).rules;
}

}  // namespace culprit::study::rca
