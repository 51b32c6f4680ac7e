// The events between breaking a robot and its recovery, counted from the manager's events.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "demo/play_outcome.h"
#include "knowledge/event.h"

namespace culprit::lab {

class Episode {
 public:
  // `rules` must outlive the episode.
  explicit Episode(const RuleSet& rules) : rules_(rules) {}

  void add(const Event& event);

  // Failures in the order of their detection; one that came twice is there twice.
  const std::vector<std::string>& failures() const { return failures_; }
  // Strategies in the order of their execution.
  const std::vector<std::string>& strategies() const { return strategies_; }
  int strategies_succeeded() const { return strategies_succeeded_; }
  // Executed strategies that redeploy a component.
  int redeployments() const { return redeployments_; }
  // Components that an incident held responsible, or else suspected, in the order in which they were first named.
  const std::vector<std::string>& blamed() const { return blamed_; }
  // Components that executed strategies redeployed.
  const std::vector<std::string>& redeployed() const { return redeployed_; }
  // From detection to resolution, for each failure that was resolved.
  const std::vector<Duration>& reactions() const { return reactions_; }

  // Failures that are there now, exhausted ones included.
  std::size_t open() const { return open_.size(); }
  bool is_exhausted() const { return is_exhausted_; }
  // Calls for a person: rules that were exhausted, and rules that only report.
  int calls() const { return calls_; }

  // The part of a play's outcome that the events know.
  PlayOutcome outcome() const;

 private:
  void on(const FailureDetected& e);
  void on(const FailureResolved& e);
  void on(const FailureLost& e) { open_.erase(e.rule); }
  void on(const StrategyChosen& e);
  void on(const RuleExhausted&) {
    is_exhausted_ = true;
    ++calls_;
  }
  void on(const IncidentOpened& e) { blame(e.incident); }
  void on(const IncidentChanged& e) { blame(e.incident); }
  void blame(const Incident& incident);
  template <class Other>
  void on(const Other&) {}

  const RuleSet& rules_;
  std::vector<std::string> failures_;
  std::vector<Duration> reactions_;
  std::set<RuleId> open_;
  std::vector<std::string> strategies_;
  std::vector<std::string> blamed_;
  std::vector<std::string> redeployed_;
  int strategies_succeeded_ = 0;
  int redeployments_ = 0;
  int calls_ = 0;
  bool is_exhausted_ = false;
};

}  // namespace culprit::lab
