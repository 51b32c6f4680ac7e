// The results of a drill: each fault, the coverage of rules and faults, and the measured numbers.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "drill/healthy.h"
#include "drill/hidden.h"
#include "drill/trial.h"
#include "language/rule_set.h"

namespace culprit::drill {

// With 95 % certainty a share lies there (E. B. Wilson, 1927). [0, 1] without a try.
struct Interval {
  double low = 0;
  double high = 1;
};
Interval interval_of(int successes, int tries);

// The middle and the largest; nothing of none.
struct Spread {
  double median = 0;
  double most = 0;
  std::size_t count = 0;
};
Spread spread_of(std::vector<double> numbers);

struct FaultResult {
  std::string fault;
  int times = 0;
  int noticed = 0;
  int blamed_rightly = 0;  // strategies were begun, and only for what was broken
  int blamed_wrongly = 0;  // a strategy was begun for something else
  int healed = 0;          // well without being undone by the drill
  int well = 0;
  std::vector<double> noticed_after;  // seconds, as the next one
  std::vector<double> well_after;
  std::map<std::string, int> first_rule;
  std::map<std::string, int> helped;
  std::map<std::string, int> silent;
  std::vector<std::string> evidence;  // of wrong blame: what culprit said
};

struct StrategyResult {
  std::string rule;
  std::string strategy;
  int tried = 0;
  int helped = 0;
  std::vector<double> effects;  // seconds
  // Of the file.
  double probability = 0;  // percent
  double confidence = 0;
  std::int64_t impact = 0;  // cycles
};

struct Results {
  std::string robot;
  std::string date;  // "2026-12-01"
  Duration cycle{};
  std::vector<FaultResult> faults;
  std::vector<StrategyResult> strategies;
  std::vector<std::string> unnoticed;     // faults
  std::vector<std::string> untripped;     // rules
  std::vector<std::string> never_helped;  // strategies that were tried
  std::map<std::string, int> touched;     // healthy components
  std::vector<HiddenDependency> hidden;
  std::vector<ThresholdMeasure> thresholds;
  std::map<std::string, std::vector<double>> starts;  // components; seconds until the node was up
  std::map<std::string, Duration> ready;  // of the file; components without are not here
  std::vector<std::string> spoilt;        // trials that prove nothing, and why
};

Results results_of(const std::vector<Trial>& trials, const RuleSet& rules, const Paths& paths,
                   const std::string& date);

// Outcomes that a measured number needs.
inline constexpr int kRepeats = 3;

// READY that the longest start needs. @pre !starts.empty()
std::chrono::seconds ready_of(const std::vector<double>& starts);

// One cycle more than the longest measured effect took. @pre !effects.empty()
std::int64_t impact_of(const std::vector<double>& effects, Duration cycle);

}  // namespace culprit::drill
