// An incident as one HTML file without a script, which needs nothing else: for a colleague who has neither the robot nor
// culprit. Who was held responsible, what was decided and why, what happened, and what the robot's topics said meanwhile.
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

// Times are those of this machine's clock, in its time zone, which is said. Names, texts and numbers are taken for what they
// are, whoever made them.
std::string incident_page(const PageContent& content);

}  // namespace culprit::incident_reports
