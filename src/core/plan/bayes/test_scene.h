// A scene to plan in: components, what depends on what, and failures, for tests of the planner.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plan/planner.h"

namespace culprit::plan {

class Scene {
 public:
  // `rules` in the rule language; all components are alive and active.
  explicit Scene(const std::string& rules);

  // `consumer` depends on `producer`.
  Scene& link(const std::string& producer, const std::string& consumer);
  // The rule's failure was detected `delay` after the scene's beginning.
  Scene& fail(const std::string& rule, Duration delay = {});
  // Its trigger is false, and shows that its function works.
  Scene& see_working(const std::string& rule);
  // Its strategy is under way, in this stage.
  Scene& attempt(const std::string& strategy, Attempt::Stage stage = Attempt::Stage::kAdapting);
  // It is there, and all was tried in vain.
  Scene& exhaust(const std::string& rule);
  Scene& tried(const std::string& strategy);
  void process(const std::string& component, ProcessState state);

  RuleId rule(const std::string& name) const;
  StrategyId strategy(const std::string& name) const;  // "Rule.strategy"
  ComponentId component(const std::string& name) const;

  // "A.restart C.redeploy": what is chosen for the failures without a strategy under way, by name.
  std::string plan(const Planner& planner);
  // The decisions of the last plan.
  const std::vector<Decision>& decisions() const { return decisions_; }
  const Decision& decision(const std::string& rule) const;
  const Candidate& candidate(const std::string& strategy) const;

  const RuleSet& rules() const { return *rules_; }
  Knowledge& operator*() { return *knowledge_; }
  Knowledge* operator->() { return knowledge_.get(); }

 private:
  std::unique_ptr<RuleSet> rules_;
  std::unique_ptr<Knowledge> knowledge_;
  std::vector<Decision> decisions_;
};

// A rule of this name and level whose failure is on `component`, with two strategies: restart (50
// %, 2 cycles) and redeploy (90 %, 10 cycles); and the component.
std::string failure_of(const std::string& component, const std::string& rule,
                       const std::string& level = "ERROR");

}  // namespace culprit::plan
