#include "study/rca/rules.h"

#include <cmath>

#include <fmt/core.h>

#include "language/checker.h"

namespace culprit::study::rca {
namespace {

// The probability that at least `needed` of `window` readings are wrong.
double tail(int needed, int window, double wrong) {
  double sum = 0;
  for (int k = needed; k <= window; ++k) {
    sum += std::exp(std::lgamma(window + 1) - std::lgamma(k + 1) - std::lgamma(window - k + 1)) *
           std::pow(wrong, k) * std::pow(1 - wrong, window - k);
  }
  return sum;
}

// The shortest window with a false detection in less than a million evaluations, and two readings
// that may be missed.
std::string hold(double wrong) {
  constexpr double kRare = 1e-6;
  if (wrong <= 0) return "";
  for (int window = 3; window <= 20; ++window) {
    if (tail(window - 2, window, wrong) < kRare)
      return fmt::format(" HOLD {}/{}", window - 2, window);
  }
  return " HOLD 18/20";
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
  for (const RcaComponent& c : scenario.components) {
    text += fmt::format("COMPONENT {0} NODE /{0} LAUNCH \"run {0}\"\n", c.name);
    text += fmt::format("SIGNAL {0}_ill DIAGNOSTIC {0} KEY ill\n", c.name);
  }
  for (const RcaComponent& c : scenario.components) {
    text +=
        fmt::format("\nRULE {0}_fails\n  POLICIES {1}{2} ATTEMPTS 12\n  TRIGGER {0}_ill == true\n",
                    c.name, level(c.criticality), hold(c.detector.false_alarm));
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
