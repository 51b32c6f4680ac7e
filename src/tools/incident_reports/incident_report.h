// The journal's and the recordings' data on one incident, for its page and for programs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "incident_reports/incident_page.h"
#include "journal/reader.h"

namespace culprit::incident_reports {

// When an incident of this id began, seconds since 1970. Nothing: no incident is called so.
std::optional<double> began_by_id(const std::string& id);

// `recordings`: the folder of the black box (recorder/recording_folder.h), which may be missing: that is said in the
// remarks, as is a recording that cannot be read. `now`: seconds since 1970. Nothing: the journal has no such incident.
// Errors: the journal cannot be read.
Expected<std::optional<PageContent>> report_of(const journal::Reader& journal,
                                               const std::string& id,
                                               const std::filesystem::path& recordings, double now);

}  // namespace culprit::incident_reports
