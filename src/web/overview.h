// How the robot is, in one word and one sentence: the same for `culprit status`, `culprit top`, the page and
// /culprit/status. No view decides this by itself.
//
// No alarm is not health: what was never seen, what no rule can see and a robot that cannot be heard have looks of
// their own.
#pragma once

#include <string>
#include <string_view>

#include "json/json.h"
#include "manager/manager.h"

namespace culprit::web {

struct Overview {
  // "OK"; of incidents "NON_CRITICAL", "WARNING", "ERROR", "EXHAUSTED"; "MISSING": a REQUIRED component is not there;
  // "BLIND", "BLIND_ERROR": no failure is seen, but some rules, one of them an ERROR rule, have no value;
  // "WATCHING_NOTHING": no rule can see; "DEAF": the robot cannot be heard; "TIME_HELD": no failure is seen, but the
  // simulated time of some components stands still; no failure is seen, but a component is "UNREACHABLE", "DEAD", "HUNG",
  // "STOPPED", "NEVER_SEEN", or in an unknown state ("BLIND").
  std::string_view look;
  std::string headline;  // "camera is down, and 1 more"
  std::string detail;    // "no failure is seen by 3 rules"; of an incident: what is done about it
};
Overview overview_of(const Manager& manager);

// How one component looks, beside its health.
struct ComponentLook {
  // As its health (web/component_health.h) where that is not OK; else "DEAD", "STOPPED", "HUNG", "UNREACHABLE": what
  // became of its process; "NEVER_SEEN"; "TIME_HELD": its /clock stands still; "BLIND": all rules about it, or it was
  // seen once, and nobody knows whether it is there; "UNWATCHED": no rule is about it; "OK".
  std::string_view look;
  std::string_view condition;  // in a word or two, for people; empty: it works
};
ComponentLook look_of(ComponentId id, std::size_t health, const Manager& manager);

Json to_json(const Overview& overview);

}  // namespace culprit::web
