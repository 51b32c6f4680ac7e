// How often strategies may be begun: in total, of each kind, at each component; how often a
// component may be restarted; and how long it is left alone after that.
//
// Asking and spending are two steps: may_begin() has no effect. Strategies that a person ran by
// hand are spent like any other.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "execute/intensity.h"
#include "knowledge/history.h"
#include "knowledge/knowledge.h"

namespace culprit::execute {

// By the most drastic of its adaptations.
enum class StrategyKind : std::uint8_t {
  kConfiguration,  // parameters, communication, modes, routines
  kLifecycle,      // activate, deactivate, restart
  kProcess         // redeploy, start, stop
};
StrategyKind kind_of(const Strategy& strategy);

class Limits {
 public:
  // A component's restarts get apart: `first` after the first one, doubled with each further one
  // up to `longest`; all is forgotten once it was well for `healthy`. first 0: no back-off.
  struct Backoff {
    Duration first{};
    Duration longest{};
    Duration healthy{};
  };
  struct Options {
    Intensity overall{};
    Intensity per_kind{};
    Intensity per_component{};
    // Per component, by whatever strategies. Beyond it a person must look; a process that is known to
    // have exited is started every five minutes.
    Intensity restarts{};
    Backoff backoff{};
    Duration quiet_after_launch{};  // for a component that was started
    // For components that depend on one that was started, or that came back without culprit: they have
    // to discover the new process first.
    Duration quiet_downstream{};
  };
  struct Limit {
    Restraint restraint = Restraint::kOverallIntensity;
    std::string reason;
    Time until = kNever;
  };

  // `knowledge` must outlive the limits.
  Limits(const Knowledge& knowledge, Options options);

  std::optional<Limit> on_all(Time now) const;
  std::optional<Limit> on(StrategyId strategy, Time now) const;
  void began(StrategyId strategy, Time now);
  // The budgets that earlier processes spent.
  void remember(const History& past);
  // An event of the step that is over.
  void note(const Event& event);

 private:
  struct PerComponent {
    IntensityBudget budget;
    IntensityBudget begun_anew;
    int restarts = 0;  // since it was proven healthy
    Time restarted = kLongAgo;
    Time well_since = kLongAgo;
    Time launched = kLongAgo;
    bool is_lost = false;
    Time came = kLongAgo;  // launched, or found again after it was lost
  };

  std::optional<Limit> backoff(ComponentId component, RuleId rule, Time now) const;
  std::optional<Limit> quiet(ComponentId component, Time now) const;
  std::optional<Limit> launched_within(Duration time, ComponentId component, Time since,
                                       Time now) const;
  std::optional<Limit> start(ComponentId component, RuleId rule, Time now) const;
  bool is_silent_since_its_start(ComponentId component, RuleId rule) const;
  // `failed`: when the failure of `rule` was detected.
  void spend(StrategyId strategy, Time now, Time failed);
  void give_back(StrategyId strategy);
  bool was_healthy(ComponentId component, RuleId rule, Time failed) const;

  const Knowledge& knowledge_;
  Options options_;
  IntensityBudget overall_;
  std::array<IntensityBudget, 3> kinds_;
  std::vector<PerComponent> components_;
};

}  // namespace culprit::execute
