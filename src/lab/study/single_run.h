// One run of a campaign, played again with all that was told of it, for people who look at it
// moment by moment.
//
// It depends on nothing but its campaign and its number, so nothing of it has to be kept.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "base/expected.h"
#include "knowledge/event.h"
#include "study/timeline.h"

namespace culprit::study {

struct SingleRun {
  std::string scenario;  // what was to go wrong, in words; empty: nobody gave it a name
  RuleSet rules;         // that the events are about
  // What the manager does not tell: the faults that went in, what the robot did. By time.
  std::vector<TimelineEntry> incidents;
  std::vector<Event> events;  // by time
  double end_s = 0;           // of the robot, from the begin of the run, as all times here
  bool is_told = true;        // false: the manager tells nothing of itself, there are no events
};

// `study` and `campaign` are what a result says (json.h, suave/report.h, rca/report.h), of whatever
// origin. Errors: what is wrong with the campaign; it has no such run.
Expected<SingleRun> play_again(std::string_view study, const nlohmann::ordered_json& campaign,
                               RunId id);

}  // namespace culprit::study
