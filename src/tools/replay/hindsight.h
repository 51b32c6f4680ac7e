// The failures that rules would have detected, and the strategies they would have begun, in the last while: for authors of rules.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "journal/reader.h"
#include "plan/planner.h"
#include "replay/recording.h"

namespace culprit::replay {

struct Said {
  enum class What : std::uint8_t { kDetected, kGone, kChosen };
  double wall = 0;  // seconds since 1970
  What what = What::kDetected;
  std::string rule;
  std::string strategy{};  // of kChosen
};

struct Hindsight {
  double since = 0;  // seconds since 1970: from when on it was recorded, and until when
  double until = 0;
  std::vector<Said> said;  // in order
  std::vector<std::string>
      missing;  // what the rules read and no run of that time has: "topic /scan"
};

// The session rows of runs that may have something of the time since `since` (nanoseconds since 1970), the oldest first: the
// newest 50 at most. Errors: the journal cannot be read.
Expected<std::vector<journal::Entry>> runs_since(const journal::Reader& journal,
                                                 std::int64_t since);

// By the settings that a run was recorded with. Errors: they cannot be read.
using PlannerOf = std::function<Expected<std::unique_ptr<const Planner>>(const journal::Session&)>;

// Since `since` (nanoseconds since 1970), over all runs of that time; each only advises on the observations. `rules`: null stands for those that ran then.
// Earlier observations are known, except the messages of topics: ages and rates begin anew. Errors: the journal has no rows since then, or is unreadable.
Expected<Hindsight> hindsight(const journal::Reader& journal, const RuleSet* rules,
                              const PlannerOf& planner_of, std::int64_t since);

}  // namespace culprit::replay
