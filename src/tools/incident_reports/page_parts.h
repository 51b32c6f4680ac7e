// The parts of which pages about incidents are put together: times, facts and tables as HTML.
#pragma once

#include <string>
#include <vector>

#include "json/json.h"

namespace culprit::incident_reports {

// A time by this machine's clock, in its time zone; `clock`: seconds since 1970. `format` as of strftime; "?" if the time has no calendar.
std::string formatted(double clock, const char* format);
std::string on_calendar(double clock);  // "2027-01-15"
std::string on_clock(double clock);     // "10:00:02.000": within an incident a second is long
std::string time_zone(double clock);    // "UTC+01:00"

// Escaped; empty if it is no text.
std::string safe_text(const Json& json, const char* key);
// Empty if there is none.
const Json& list_in(const Json& json, const char* key);
// A class of the page's style, for the criticality of an event: one of three. A word of a stranger is none of them.
const char* criticality_class(const Json& event);
// The time of an event, in seconds since 1970.
double clock_of(const Json& event);

// The cells are HTML, also below.
std::string row_of(const std::vector<std::string>& cells);
std::string fact(const char* name, const std::string& value);
std::string table_of(const std::vector<std::string>& heads, const std::string& rows);

}  // namespace culprit::incident_reports
