#include "study/timeline.h"

#include <fmt/core.h>

#include "json/json.h"

namespace culprit::study {

std::string_view name(Happening happening) {
  switch (happening) {
    case Happening::kFault:
      return "fault";
    case Happening::kFailure:
      return "failure";
    case Happening::kBlame:
      return "blame";
    case Happening::kAdaptation:
      return "adaptation";
    case Happening::kResolved:
      return "resolved";
    case Happening::kGaveUp:
      return "gave up";
    case Happening::kNote:
      return "note";
  }
  return "note";
}

std::string timelines_json(const std::vector<Timeline>& timelines) {
  Json document = Json::array();
  for (const Timeline& timeline : timelines) {
    std::string title = fmt::format("run {} of {}", timeline.run, label(timeline.configuration));
    if (!timeline.scenario.empty()) title += ": " + timeline.scenario;
    Json entries = Json::array();
    for (const TimelineEntry& entry : timeline.entries)
      entries.push_back({{"time", entry.time_s},
                         {"kind", name(entry.kind)},
                         {"text", entry.text},
                         {"component", entry.component}});
    document.push_back({{"label", std::move(title)}, {"entries", std::move(entries)}});
  }
  return to_indented(document) + "\n";
}

}  // namespace culprit::study
