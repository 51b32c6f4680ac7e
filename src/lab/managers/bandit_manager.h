// culprit's manager with a bandit in the planner's place: the failures of a robot, and of each
// failure the strategy that a policy plays next. No dependency graph is asked, and nothing is
// deferred: an outcome is credited to the strategy that was executed, whatever else happened.
//
//   rebet-ucb, rebet-greedy, rebet-random   ReBeT's external adaptation: each failure by itself,
//                                           in ticks of the tree (paced_manager.h)
//   bandit                                  Thompson sampling, each failure by itself, at once
//   random                                  one failure of chance at a time, any strategy, as
//                                           SUAVE's Random does with functions and modes
//
// In favour of all: a strategy that did not help is not played again before the others were.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "manager/manager.h"
#include "managers/bandit.h"

namespace culprit::study {

struct BanditKind {
  std::string_view name;
  BanditPolicy policy = BanditPolicy::kRandom;
  bool is_one_at_a_time = false;

  // Whether it gets better with experience.
  bool learns() const { return policy != BanditPolicy::kRandom; }
};

// Null for another name.
const BanditKind* find_bandit(std::string_view name);

// By strategy: what was experienced.
using BanditExperience = std::vector<BanditArm>;

// Before any experience: what the rules believe.
BanditExperience no_experience(const RuleSet& rules);

class BanditManager : public ManagingSystem {
 public:
  // `rules` must outlive it.
  BanditManager(const RuleSet& rules, const BanditKind& kind, BanditExperience experience,
                std::uint64_t seed, Manager::Options options);
  ~BanditManager() override;

  std::vector<Command> step(Time now, std::span<const Observation> observations) override;
  Time next_deadline() const override;
  std::span<const Event> events() const override;

  const BanditExperience& experience() const;

 private:
  struct Memory;

  std::unique_ptr<Memory> memory_;  // the planner refers to it
  Manager manager_;
};

}  // namespace culprit::study
