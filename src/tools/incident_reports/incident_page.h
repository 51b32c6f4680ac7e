// An incident as one HTML file without a script or other files: for a colleague without the robot or culprit. It shows the blamed component, the decisions with
// their reasons, the events, and the robot's topics meanwhile.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "incident_reports/incident.h"
#include "incident_reports/recorded_curves.h"

namespace culprit::incident_reports {

struct PageContent {
  Incident incident;
  std::string robot;
  std::vector<Json> events;              // as GET /api/incidents/events tells them (docs/web.md)
  std::vector<std::string> recordings;   // names of files; empty: nothing was recorded
  std::optional<RecordedCurves> curves;  // of one of them; nothing: `remarks` say why
  std::vector<std::string> remarks;      // sentences about the recording
  double written_at = 0;                 // seconds since 1970
};

// Times are those of this machine's clock, in its time zone, which the page names. Names, texts and numbers are escaped, whatever their origin.
std::string incident_page(const PageContent& content);

}  // namespace culprit::incident_reports
