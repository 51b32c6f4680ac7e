// Follows incidents (live/situation.h) from their beginning to their end, by the names of the rules
// that fail. If another manager begins, for example after the rules were reloaded, an incident that
// it does not report yet counts as lost. If its failure has not cleared, it becomes a new incident.
//
// Each incident gives these messages on /culprit/incidents: one when it begins, one when something
// about it has changed, at most every kPeriod, and one when it is over.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "json/json.h"
#include "live/situation.h"
#include "ros_api/culprit_types.h"

namespace culprit::ros_api {

using WallTime = std::chrono::system_clock::time_point;

// A builtin_interfaces/Time.
Json stamp_of(WallTime at);

class IncidentWatch {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds(250);

  explicit IncidentWatch(const CulpritTypes& types) : types_(types) {}

  // Takes the events since the last call: how failures ended.
  void note(std::span<const Event> events, const RuleSet& rules);

  // Messages for the topic. `all` are the incidents now, `wall` is the time on the wall of `now`.
  std::vector<Json> look(const std::vector<live::Incident>& all, const RuleSet& rules, Time now,
                         WallTime wall);
  // When a change may be published; kNever: all is told.
  Time due() const { return due_; }

  // Those that are open, as they were at the last look, the worst first.
  std::vector<Json> open() const;

 private:
  struct Followed {
    std::string id;
    WallTime since;
    std::set<std::string> rules;  // that fail, or failed until then
    Json message;                 // as it is now
    Json told;                    // as published last, without what changes with the time
    Time told_at = kLongAgo;
  };

  Followed& followed(const live::Incident& incident, const std::set<std::string>& rules,
                     const std::set<std::string>& roots, const std::string& root,
                     std::set<std::string>& taken, Time now, WallTime wall);
  Json ended(const Followed& each, WallTime wall) const;

  const CulpritTypes& types_;
  std::vector<Followed> all_;                // the worst first
  std::map<std::string, bool> is_resolved_;  // by rule: its failure is gone, or not seen any more
  Time due_ = kNever;
};

}  // namespace culprit::ros_api
