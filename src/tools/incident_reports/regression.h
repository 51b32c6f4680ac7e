// A regression test from an incident: its part of the recording, the rules of that run, and a test that expects again what
// was detected and blamed then.
//
//     rover.test   RULES rover.rules · BAG rover.mcap · EXPECT LidarDead DETECTED BY 21.4s · EXPECT BLAME lidar
//
// Only what the recording shows again is expected, so the test passes as it is written; the rest stands in it as comments.
#pragma once

#include <filesystem>

#include "incident_reports/incident.h"
#include "journal/reader.h"

namespace culprit::incident_reports {

struct ExportedTest {
  std::filesystem::path test, bag, rules;
  std::size_t expectations = 0;
};

// Writes below `folder`, which is made if it is not there, and overwrites nothing. `recordings` as for report_of(). Errors:
// the journal has no such incident or not its rules, there is no recording of it, or something cannot be read or written.
Expected<ExportedTest> export_test(const journal::Reader& journal, const std::string& id,
                                   const std::filesystem::path& recordings,
                                   const std::filesystem::path& folder);

// Copies the messages that were recorded from `from` to `until` (nanoseconds since 1970) to a new MCAP file; of transient
// local topics also the last one before, at `from`. Gives how many. Errors: the bag cannot be read, or the file not written.
Expected<std::uint64_t> cut_bag(const std::filesystem::path& bag, std::int64_t from,
                                std::int64_t until, const std::filesystem::path& to);

}  // namespace culprit::incident_reports
