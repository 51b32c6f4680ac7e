// Adds up the rows of a journal for a fleet: how often each strategy helped, and the failures of
// each run. Pure: the same rows give the same sums. So a process that was killed in between begins
// anew with the first row of the run, and nothing is counted twice.
//
// A run is the rows after one `session` row, and its id is the hash of that row. No two runs of all
// robots have the same id, and a copy of a journal goes on with rows, and runs, of its own.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "journal/entry.h"
#include "json/json.h"

namespace culprit::fleet {

struct Run {
  std::string id;          // 32 hexadecimal digits
  std::int64_t row = 0;    // of the journal, where it begins
  std::int64_t began = 0;  // nanoseconds since 1970, by the robot's wall clock
  std::string culprit;     // its version
  std::string model;       // what the rules call the robot
  std::string rule_set;    // 16 hexadecimal digits of the hash of the rule file
  std::string context;     // that the robot works in, as it was started with
};

struct Counts {
  std::int64_t helped = 0;
  std::int64_t failed = 0;
  bool operator==(const Counts&) const = default;
};

struct StrategyName {
  std::string rule;
  std::string strategy;
  auto operator<=>(const StrategyName&) const = default;
};

struct Failure {
  std::int64_t row = 0;  // where it was detected
  std::int64_t incident =
      0;  // incident_number.h; of an older culprit: the row of the first failure since all was well
  std::string rule;
  std::string criticality;
  std::string component;        // the blamed one; empty: unknown
  std::int64_t began = 0;       // nanoseconds since 1970
  std::int64_t ended = 0;       // 0: it is still there
  double repair_seconds = -1;   // by the robot's own clock; below zero: it was not resolved
  std::string how;              // resolved, lost, left (culprit ended); empty while it is there
  std::string helped_by;        // the strategy
  std::int64_t strategies = 0;  // begun for it
  std::int64_t failed = 0;      // and did not help
  bool is_exhausted = false;
};

class Tally {
 public:
  // `hash`: of the row. Rows come in their order.
  void take(const journal::Entry& entry, std::string_view hash);

  // The newest run; nothing: no row of a run yet.
  const std::optional<Run>& run() const { return run_; }
  const std::string& rules_text() const { return rules_text_; }
  const std::map<StrategyName, Counts>& counts() const { return counts_; }
  // Failures that began or changed since they were last taken, and those of a run that is over. A failure without an
  // incident is not taken yet: a later row of the same step names it.
  std::vector<Failure> take_failures();
  // Begins with this row, or what comes after it.
  void begin_at(std::int64_t row) { last_row_ = row - 1; }
  std::int64_t next_row() const { return last_row_ + 1; }

  // Whether the row begins another run: the results of this one must be taken first.
  static bool begins_run(const journal::Entry& entry);

 private:
  void begin(const journal::Entry& entry, std::string_view hash);
  void event(const journal::Entry& entry);
  void take_incident(const Json& body);
  Failure* open_failure(const std::string& rule);
  void close(Failure& failure, std::int64_t at, const char* how);

  std::optional<Run> run_;
  std::string rules_text_;
  std::map<StrategyName, Counts> counts_;
  std::map<std::string, Failure> open_;  // by rule
  std::vector<Failure> changed_;         // that are over
  std::map<std::string, bool> is_new_;   // of open ones: changed since they were taken
  bool tells_incidents_ = false;         // the culprit of this run does
  std::int64_t incident_ = 0;            // else
  std::int64_t last_row_ = 0;
  std::int64_t last_at_ = 0;
};

}  // namespace culprit::fleet
