#include "study/published.h"

#include <cmath>

namespace culprit::study::published {
namespace {

constexpr PaperSwitches on(bool dependencies, bool criticality, bool impact) {
  return {dependencies, criticality, impact};
}

constexpr Probabilities kIdeal = Probabilities::kIdeal;

constexpr std::array<Result, 8> kAblation = {{
    {on(false, false, false), kIdeal, {{{0.75, 0.20}, {2.63, 1.76}, {4.90, 1.12}, {1.41, 1.11}}}},
    {on(false, false, true), kIdeal, {{{0.78, 0.19}, {2.16, 2.50}, {4.72, 2.73}, {0.56, 0.83}}}},
    {on(false, true, false), kIdeal, {{{0.74, 0.19}, {2.69, 1.81}, {5.37, 1.43}, {1.49, 1.18}}}},
    {on(false, true, true), kIdeal, {{{0.79, 0.18}, {1.95, 2.42}, {4.65, 2.83}, {0.49, 0.75}}}},
    {on(true, false, false), kIdeal, {{{0.83, 0.17}, {2.11, 1.62}, {5.17, 1.16}, {1.43, 1.13}}}},
    {on(true, false, true), kIdeal, {{{0.81, 0.16}, {2.01, 2.42}, {4.51, 2.51}, {0.32, 0.67}}}},
    {on(true, true, false), kIdeal, {{{1.38, 0.47}, {2.79, 1.99}, {5.20, 1.65}, {0.81, 0.98}}}},
    {on(true, true, true), kIdeal, {{{1.01, 0.33}, {1.97, 2.41}, {4.49, 2.49}, {0.18, 0.45}}}},
}};

constexpr std::array<Result, 2> kRobustness = {{
    {on(true, true, true), kIdeal, {{{1.01, 0.33}, {1.97, 2.41}, {4.49, 2.49}, {0.18, 0.45}}}},
    {on(true, true, true),
     Probabilities::kMisspecified,
     {{{0.98, 0.30}, {2.02, 2.52}, {4.48, 2.89}, {0.26, 0.59}}}},
}};

constexpr Change grey(double percent) { return {percent, Significance::kNotSignificant}; }
constexpr Change green(double percent) { return {percent, Significance::kBetter}; }
constexpr Change red(double percent) { return {percent, Significance::kWorse}; }

constexpr Factor kD = Factor::kDependencies;
constexpr Factor kC = Factor::kCriticality;
constexpr Factor kS = Factor::kImpact;

constexpr std::array<Effect, 12> kEffects = {{
    {kD,
     on(false, false, false),
     on(true, false, false),
     {{grey(10.67), grey(-19.77), grey(5.51), grey(1.42)}}},
    {kD,
     on(false, true, false),
     on(true, true, false),
     {{green(86.49), grey(3.72), grey(-3.17), green(-45.64)}}},
    {kD,
     on(false, false, true),
     on(true, false, true),
     {{grey(3.85), grey(-6.94), grey(-4.45), green(-42.86)}}},
    {kD,
     on(false, true, true),
     on(true, true, true),
     {{green(27.85), grey(1.03), grey(-3.44), green(-63.27)}}},
    {kC,
     on(false, false, false),
     on(false, true, false),
     {{grey(-1.33), grey(2.28), grey(9.59), grey(5.67)}}},
    {kC,
     on(true, false, false),
     on(true, true, false),
     {{green(66.27), red(32.23), grey(0.58), green(-43.36)}}},
    {kC,
     on(false, false, true),
     on(false, true, true),
     {{grey(1.28), grey(-9.72), grey(-1.48), grey(-12.50)}}},
    {kC,
     on(true, false, true),
     on(true, true, true),
     {{green(24.69), grey(-1.99), grey(-0.44), green(-43.75)}}},
    {kS,
     on(false, false, false),
     on(false, false, true),
     {{grey(4.00), grey(-17.87), grey(-3.67), green(-60.28)}}},
    {kS,
     on(true, false, false),
     on(true, false, true),
     {{grey(-2.41), grey(-4.74), grey(-12.77), green(-77.62)}}},
    {kS,
     on(false, true, false),
     on(false, true, true),
     {{grey(6.76), green(-27.51), grey(-13.41), green(-67.11)}}},
    {kS,
     on(true, true, false),
     on(true, true, true),
     {{red(-26.81), green(-29.39), grey(-13.65), green(-77.78)}}},
}};

}  // namespace

Moments sample(const MeanSd& value) {
  const double n = kRuns;
  return Moments::of_summary(value.mean, value.sd * std::sqrt(n / (n - 1)), kRuns);
}

std::span<const Result, 8> ablation() { return kAblation; }
std::span<const Result, 2> robustness() { return kRobustness; }
std::span<const Effect, 12> effects() { return kEffects; }

std::optional<Values> values_of(const Configuration& configuration) {
  for (const std::span<const Result> table :
       {std::span<const Result>(kAblation), std::span<const Result>(kRobustness)}) {
    for (const Result& result : table) {
      if (result.switches == configuration.switches &&
          result.probabilities == configuration.probabilities)
        return result.values;
    }
  }
  return std::nullopt;
}

}  // namespace culprit::study::published
