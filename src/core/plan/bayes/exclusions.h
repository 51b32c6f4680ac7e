// Obstacles that exclude a strategy from a plan: other strategies around the components that it
// adapts.
#pragma once

#include <array>
#include <span>

#include "diagnose/examination.h"
#include "plan/bayes/levels.h"

namespace culprit::plan {

// A strategy that helps at least so likely, and takes nothing down, need not wait for failures
// downstream of it: its own effect may be hidden, but hardly matters.
inline constexpr double kSure = 0.9;

// Does it take a component down, if only for a moment?
bool takes_down(const Adaptation& adaptation);
bool takes_down(const Strategy& strategy);

// Places (see Reach) where something stands against adapting them, and why.
class Exclusions {
 public:
  // `failures`: those to be decided about for which a strategy may begin. Yielding to the others would block these as long.
  Exclusions(const Knowledge& knowledge, const diagnose::Examination& found, const Levels& levels,
             std::span<const RuleId> failures);

  struct Obstacle {
    Condition condition = Condition::kAdapting;
    ComponentId component;  // see Candidate
    std::optional<RuleId> because;
  };
  // All that a strategy adapts or ends.
  using Places = std::vector<std::size_t>;
  Places affected(const Strategy& strategy) const;
  // The strategy that reserves one of the components, if any does that need not give way at this
  // level.
  std::optional<Obstacle> reserved(Criticality level, const Places& places) const;
  // Another obstacle against adapting the component at `place` by this strategy, if there is one.
  // `chance` is u of the strategy (plan/bayes/strategy_chances.h).
  std::optional<Obstacle> obstacle(std::size_t place, const Strategy& strategy,
                                   double chance) const;

  // From now on a strategy of the rule is carried out as well. A strategy that only replaces dead
  // processes is not disturbed by others upstream.
  enum class Disturbance : std::uint8_t { kNone, kFromUpstream };
  void add(RuleId rule, const Places& places, Disturbance disturbance);
  // Is it adapted by one of those that were added?
  std::optional<Obstacle> taken(std::size_t place) const;
  // The conflict with the strategies that were added, if there is one.
  std::optional<Obstacle> conflict(std::size_t place) const;

 private:
  // Places, and the failure that each is about.
  struct Marks {
    explicit Marks(std::size_t places) : at(1, places), failure(places) {}
    void mark(std::size_t place, RuleId rule) {
      if (!diagnose::has(at[0], place)) failure[place] = rule;
      diagnose::set(at[0], place);
    }
    std::span<const diagnose::Word> bits() const { return at[0]; }

    diagnose::BitRows at;
    std::vector<RuleId> failure;
  };
  std::optional<Obstacle> in_the_way(std::size_t place, const Marks& marks) const;
  std::size_t level_of(RuleId rule) const { return static_cast<std::size_t>(levels_.of(rule)); }
  std::optional<Obstacle> found(Condition condition, std::span<const diagnose::Word> where,
                                const Marks& marks) const;

  const Knowledge& knowledge_;
  std::span<const std::optional<diagnose::TroubleSeen>> troubles_;
  const diagnose::Reach& reach_;
  const Levels& levels_;
  // By level: reserved by attempts, and holding back what depends on it. Not by one that is less
  // critical and only waits for its verdict: it gives way.
  std::vector<Marks> holding_;
  // By level: the living components of more critical failures that are worked on; the same of
  // `failures`.
  std::vector<Marks> urgent_;
  std::vector<Marks> planned_;
  std::vector<Marks> judged_;    // by level: of those whose strategy waits for its verdict
  std::vector<Marks> imminent_;  // by level: of imminent rules that are more critical
  Marks added_;
  Marks guarded_;  // of those added, the ones that must not be disturbed from upstream
};

}  // namespace culprit::plan
