// One run of a campaign with all of its reported events, for people who look at it moment by
// moment.
#pragma once

#include <string>
#include <vector>

#include "knowledge/event.h"
#include "study/timeline.h"

namespace culprit::study {

struct SingleRun {
  std::string scenario;  // what was to go wrong, in words; empty: nobody gave it a name
  RuleSet rules;         // that the events are about
  // Entries that the manager does not report: the injected faults, the robot's actions. By time.
  std::vector<TimelineEntry> incidents;
  std::vector<Event> events;  // by time
  double end_s = 0;           // of the robot, from the begin of the run, as all times here
  bool is_told = true;        // false: the manager tells nothing of itself, there are no events
};

}  // namespace culprit::study
