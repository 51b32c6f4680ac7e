// The timeline of one run: which components failed, which were blamed, and how they were repaired.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "study/campaign.h"

namespace culprit::study {

enum class Happening : std::uint8_t {
  kFault,       // went in
  kFailure,     // was detected
  kBlame,       // a component is held responsible
  kAdaptation,  // was begun
  kResolved,    // a failure is over
  kGaveUp,      // a strategy did not help, or a rule is exhausted
  kNote
};

std::string_view name(Happening happening);  // "fault", "failure", ..., for people and in JSON

struct TimelineEntry {
  double time_s = 0;  // of the robot, from the begin of the run
  Happening kind = Happening::kNote;
  std::string component;  // empty: of no component
  std::string text;       // a sentence
};

struct Timeline {
  Configuration configuration;
  std::uint32_t run = 0;
  std::string scenario;
  std::vector<TimelineEntry> entries;  // by time
};

// An array: {"label": "run 37 of D C S: ...", "entries": [{"time": seconds, "kind": "fault",
// "text": "...", "component": "camera"}]}
std::string timelines_json(const std::vector<Timeline>& timelines);

}  // namespace culprit::study
