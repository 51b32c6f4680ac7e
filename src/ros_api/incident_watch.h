// What a reader of /culprit/incidents is told: one message when an incident begins, one when something about
// it changed, at most every kPeriod, and one when it is over.
//
// The manager finds incidents (incidents/incidents.h). One that another manager does not go on with, since the rules
// were reloaded, say, is lost: if it is still there, it is a new one.
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

  // What happened since it was called last. Gives the messages of incidents that are over.
  std::vector<Json> note(std::span<const Event> events, WallTime wall);

  // Messages for the topic. `wall` is the time on the wall of `now`.
  std::vector<Json> look(const Manager& manager, Time now, WallTime wall);
  // When something that changed may be told; kNever: all is told.
  Time due() const { return due_; }

  // Those that are open, as they were at the last look, in the order of all views.
  std::vector<Json> open() const;

 private:
  struct Followed {
    std::string id;
    WallTime since;
    Json message;  // as it is now
    Json told;     // as it was told last, without what changes with the time
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
