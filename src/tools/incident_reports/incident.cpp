#include "incident_reports/incident.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "journal/json.h"
#include "knowledge/describe.h"

namespace culprit::incident_reports {

bool comes_before(const Incident& a, const Incident& b) {
  if (a.is_over != b.is_over) return b.is_over;
  if (a.is_over) return a.began > b.began;
  if (a.needs_person != b.needs_person) return a.needs_person;
  if (a.criticality != b.criticality) return a.criticality > b.criticality;
  return a.began < b.began;
}

std::string id_of_beginning(double began) {
  constexpr std::string_view kDigits = "0123456789abcdefghijklmnopqrstuvwxyz";
  std::string id;
  for (auto rest = static_cast<std::uint64_t>(std::max(0.0, std::round(began * 1000)));
       rest > 0 || id.empty(); rest /= kDigits.size())
    id.insert(id.begin(), kDigits[rest % kDigits.size()]);
  return id;
}

void cut_off(Incident& incident, double until) {
  incident.is_cut = incident.is_over = true;
  incident.seconds = std::max(incident.seconds, until - incident.began);
}

void add_to(std::vector<std::string>& names, const std::string& name) {
  if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
}

Criticality criticality_of(const Json& event) {
  const std::string word = journal::text_of(event, "criticality");
  for (const Criticality each : {Criticality::kError, Criticality::kWarning}) {
    if (word == to_string(each)) return each;
  }
  return Criticality::kNonCritical;
}

}  // namespace culprit::incident_reports
