// An incident as one HTML file without a script or other files: for a colleague without the robot or culprit. It shows the blamed component, the evidence
// on one time axis, the decisions with their reasons, the requests and their answers, the events, and the robot's topics meanwhile.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "incident_reports/incident.h"
#include "incident_reports/incident_requests.h"
#include "incident_reports/recorded_curves.h"

namespace culprit::incident_reports {

// A whole recording, of which the page is then about: its incidents instead of the one.
struct WholeRecording {
  struct Line {
    double began = 0;    // seconds since 1970
    double seconds = 0;  // how long; to the end of the recording, if it lasts
    std::string headline{}, effects{}, end{};
  };
  std::vector<Line> incidents{};
  std::string rules{};  // "8 rules, of which 3 fired"
};

struct PageContent {
  Incident incident;  // of a whole recording: its time, and the rules that fired in it
  std::optional<WholeRecording> whole{};
  std::string robot;
  std::vector<Json> events;              // as GET /api/incidents/events tells them (docs/web.md)
  std::vector<Request> requests{};       // in the order of their times
  std::vector<std::string> recordings;   // names of files; empty: nothing was recorded
  std::optional<RecordedCurves> curves;  // of one of them; nothing: `remarks` say why
  std::vector<std::string> remarks;      // sentences about the recording
  double written_at = 0;                 // seconds since 1970
};

// Times are those of this machine's clock, in its time zone, which the page names. Names, texts and numbers are escaped, whatever their origin.
std::string incident_page(const PageContent& content);

}  // namespace culprit::incident_reports
