// The messages for readers of /culprit/incidents: one message when an incident begins, one when something about
// it has changed, at most every kPeriod, and one when it is over.
//
// The manager finds incidents (incidents/incidents.h). If another manager begins, for example after the rules
// were reloaded, an incident that it does not continue counts as lost. If its failure has not cleared, it becomes a new
// incident.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "json/json.h"
#include "manager/manager.h"
#include "ros_api/culprit_types.h"

namespace culprit::ros_api {

using WallTime = std::chrono::system_clock::time_point;

// A builtin_interfaces/Time.
Json stamp_of(WallTime at);

class IncidentWatch {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds(250);

  explicit IncidentWatch(const CulpritTypes& types) : types_(types) {}

  // Takes the events since the last call. Gives the messages of incidents that are over.
  std::vector<Json> note(std::span<const Event> events, WallTime wall);

  // Messages for the topic. `wall` is the time on the wall of `now`.
  std::vector<Json> look(const Manager& manager, Time now, WallTime wall);
  // When a change may be published; kNever: all is told.
  Time due() const { return due_; }

  // Those that are open, as they were at the last look, in the order of all views.
  std::vector<Json> open() const;

 private:
  struct Followed {
    std::string id;
    WallTime since;
    Json message;  // as it is now
    Json told;     // as published last, without what changes with the time
    Time told_at = kLongAgo;
  };

  Json message_of(const Incident& incident, const Manager& manager, WallTime since,
                  WallTime wall) const;
  Json ended(const Followed& each, IncidentEnd how, WallTime wall) const;

  const CulpritTypes& types_;
  std::vector<Followed> all_;
  Time due_ = kNever;
};

}  // namespace culprit::ros_api
