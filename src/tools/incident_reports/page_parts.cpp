#include "incident_reports/page_parts.h"

#include <cmath>
#include <ctime>

#include <fmt/core.h>

#include "base/xml.h"
#include "journal/json.h"

namespace culprit::incident_reports {

std::string formatted(double clock, const char* format) {
  const auto seconds = static_cast<std::time_t>(std::floor(clock));
  std::tm parts{};
  char text[64] = "?";
  if (clock >= 0 && clock < 1e11 && localtime_r(&seconds, &parts) != nullptr)
    std::strftime(text, sizeof text, format, &parts);
  return text;
}

std::string on_calendar(double clock) { return formatted(clock, "%Y-%m-%d"); }

std::string on_clock(double clock) {
  const double rounded = std::round(clock * 1000) / 1000;
  const auto milliseconds = static_cast<int>(std::round(1000 * (rounded - std::floor(rounded))));
  return formatted(rounded, "%H:%M:%S") + fmt::format(".{:03}", milliseconds % 1000);
}

std::string time_zone(double clock) {
  std::string zone = formatted(clock, "%z");
  if (zone.size() == 5) zone.insert(3, ":");
  return "UTC" + zone;
}

std::string safe_text(const Json& json, const char* key) {
  return xml_escaped(journal::text_of(json, key));
}
std::string row_of(const std::vector<std::string>& cells) {
  std::string row;
  for (const std::string& cell : cells) row += "<td>" + cell + "</td>";
  return "<tr>" + row + "</tr>\n";
}
std::string fact(const char* name, const std::string& value) {
  return std::string("<tr><th scope=\"row\">") + name + "</th><td>" + value + "</td></tr>\n";
}
std::string table_of(const std::vector<std::string>& heads, const std::string& rows) {
  std::string head;
  for (const std::string& each : heads) head += "<th scope=\"col\">" + each + "</th>";
  return "<table><thead><tr>" + head + "</tr></thead><tbody>" + rows + "</tbody></table>\n";
}
const Json& list_in(const Json& json, const char* key) {
  static const Json kNone = Json::array();
  const auto found = json.find(key);
  return found != json.end() && found->is_array() ? *found : kNone;
}
const char* criticality_class(const Json& event) {
  const std::string criticality = journal::text_of(event, "criticality");
  if (criticality == "ERROR") return "ERROR";
  return criticality == "WARNING" ? "WARNING" : "NON_CRITICAL";
}
double clock_of(const Json& event) { return journal::number_of(event, "clock"); }

}  // namespace culprit::incident_reports
