// What excludes a strategy from a plan: what else is going on around the components that it adapts.
#pragma once

#include <array>
#include <span>

#include "plan/bayes/levels.h"

namespace culprit::plan {

// Which components a plan looks at: those that active and exhausted rules touch, those of
// suspicious rules while anyone waits to see whether they fail, and those that are not heard.
std::vector<ComponentId> components_of_interest(const Knowledge& knowledge,
                                                std::span<const RuleId> suspicious);

// Those of the suspicious rules for which a failure of `failures` still waits, to see whether they
// fail.
std::vector<RuleId> awaited(std::span<const RuleId> suspicious, std::span<const RuleId> failures,
                            const Knowledge& knowledge);

// Does it take a component down, if only for a moment?
bool takes_down(const Adaptation& adaptation);
bool takes_down(const Strategy& strategy);

// How long a failure waits, from its detection on, to see whether a suspicious rule fails.
Duration longest_wait(RuleId suspicious, const Knowledge& knowledge);

// Places (see Reach) where something stands against adapting them, and why.
class Exclusions {
 public:
  // `failures` are those to be decided about; what waits for a person is not among them: whoever
  // made way for it would wait as long.
  Exclusions(const Knowledge& knowledge, const Reach& reach, const Levels& levels,
             std::span<const RuleId> failures, std::span<const RuleId> suspicious);

  struct Obstacle {
    Condition condition = Condition::kAdapting;
    ComponentId component;  // see Candidate
    std::optional<RuleId> because;
  };
  // All that a strategy adapts or ends.
  using Places = std::vector<std::size_t>;
  Places affected(const Strategy& strategy) const;
  // Who has one of the components, if anybody does that need not give way at this level.
  std::optional<Obstacle> reserved(Criticality level, const Places& places) const;
  // What else stands against adapting the component at `place` by this strategy, if anything does.
  // `chance` is u of the strategy (plan/bayes/strategy_chances.h).
  std::optional<Obstacle> obstacle(std::size_t place, const Strategy& strategy,
                                   double chance) const;

  // From now on a strategy of the rule is carried out as well. What only replaces dead processes is
  // not disturbed by what is done upstream.
  enum class Disturbance : std::uint8_t { kNone, kFromUpstream };
  void add(RuleId rule, const Places& places, Disturbance disturbance);
  // Is it adapted by one of those that were added?
  std::optional<Obstacle> taken(std::size_t place) const;
  // What the strategies that were added stand against.
  std::optional<Obstacle> conflict(std::size_t place) const;

 private:
  // Places, and the failure that each is about.
  struct Marks {
    explicit Marks(std::size_t places) : at(1, places), failure(places) {}
    void mark(std::size_t place, RuleId rule) {
      if (!has(at[0], place)) failure[place] = rule;
      set(at[0], place);
    }
    std::span<const Word> bits() const { return at[0]; }

    BitRows at;
    std::vector<RuleId> failure;
  };
  std::optional<Obstacle> in_the_way(std::size_t place, const Marks& marks) const;
  std::optional<Obstacle> pending_suspicion(std::size_t place, const Strategy& strategy,
                                            double chance) const;
  std::size_t level_of(RuleId rule) const { return static_cast<std::size_t>(levels_.of(rule)); }
  std::optional<Obstacle> found(Condition condition, std::span<const Word> where,
                                const Marks& marks) const;

  const Knowledge& knowledge_;
  const Reach& reach_;
  const Levels& levels_;
  // By level: reserved by attempts, and holding back what depends on it. Not by one that is less
  // critical and only waits for its verdict: it gives way.
  std::vector<Marks> holding_;
  // By level: the living components of more critical failures that are worked on; the same of
  // `failures`.
  std::vector<Marks> urgent_;
  std::vector<Marks> planned_;
  std::vector<Marks> judged_;       // by level: of those whose strategy waits for its verdict
  std::vector<Marks> pending_;      // by level: of suspicious rules that are more critical
  Marks suspects_;                  // of suspicious rules
  std::vector<Duration> patience_;  // by place: how long a failure waits for the suspicious there
  Marks added_;
  Marks guarded_;  // of those added, what may not be disturbed from upstream
};

}  // namespace culprit::plan
