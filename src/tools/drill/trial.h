// One fault of a drill and what culprit made of it: recorded as a line of JSON, then read as a finding.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "drill/fault.h"
#include "language/rule_set.h"

namespace culprit::drill {

// Times are on the clock, in seconds since 1970.
struct Trial {
  std::vector<Fault> faults;
  int round = 1;
  double injected = 0;
  std::optional<double> undone{};  // by the drill, if culprit had not healed the robot before
  std::optional<double> well{};    // from when on the robot was well again
  // When the drill took the fault back from a robot that was well with it. Failures after that are none of the fault.
  std::optional<double> restored{};
  double end = 0;                          // the robot was well until then, unless it never was
  std::vector<Json> events{};              // of culprit (docs/web.md), from `injected` on
  std::map<std::string, double> silent{};  // components whose topics fell silent, and when
  std::string trouble{};                   // why it proves nothing: "aborted"; empty: it counts

  std::string id() const;
};
Json to_json(const Trial& trial);
std::optional<Trial> trial_from(const Json& json);

// Rules that the drill adds to those of the file begin so. Their events are no findings.
inline constexpr std::string_view kOwnRules = "drill_";
bool is_of_own_rule(const Json& event);

// Which component needs which, by name, over any number of edges.
using Paths = std::set<std::pair<std::string, std::string>>;  // consumer, producer
Paths paths_over(const std::vector<std::pair<std::string, std::string>>& edges);

struct Finding {
  std::optional<double> noticed_after;  // seconds, until the first failure was detected
  std::string rule;                     // that detected it
  std::set<std::string> fired;          // all rules that did
  std::set<std::string> blamed;         // components of the strategies that were begun
  std::set<std::string> wrongly;        // of those: no fault was injected there
  std::vector<std::string> helped;      // "Rule.strategy"
  std::optional<double> well_after;
  std::set<std::string> silent;  // components beside the broken ones
};
// Counts as noticed what one of `rules` detected; empty: any rule.
Finding finding_of(const Trial& trial, const std::set<std::string>& rules = {});

// The outcome of a strategy in a trial, if the strategy can have caused it.
struct Attempted {
  std::string rule;
  std::string strategy;
  bool succeeded = false;
  std::optional<double> effect;  // seconds from the last adaptation to the end of the failure
};
std::vector<Attempted> attempts_in(const Trial& trial);

}  // namespace culprit::drill
