#include "incident_reports/incident_reader.h"

#include <algorithm>

#include "journal/json.h"

namespace culprit::incident_reports {
namespace {

constexpr double kShortlyBefore = 2;  // s, from the loss of a component to the failure it causes
constexpr std::size_t kMostLossesKept = 16;
constexpr double kSecondsInNanosecond = 1e-9;

std::vector<std::string> names_at(const Json& event, const char* key) {
  std::vector<std::string> names;
  const auto list = event.find(key);
  if (list == event.end() || !list->is_array()) return names;
  for (const Json& each : *list) {
    if (each.is_string()) names.push_back(each.get<std::string>());
  }
  return names;
}

}  // namespace

bool IncidentReader::has(const std::string& id) const {
  return std::ranges::find(all_, id, &Incident::id) != all_.end();
}

void IncidentReader::add(const Told& told) {
  const std::string type = journal::text_of(told.event, "type");
  const std::string id = journal::text_of(told.event, "incident");
  if (type == "failure_detected") {
    detected_[journal::text_of(told.event, "rule")] = told.row;
  } else if (type == "component_lost") {
    losses_.push_back({told.row, told.robot, journal::text_of(told.event, "component")});
    if (losses_.size() > kMostLossesKept) losses_.pop_front();
  } else if (type == "incident_closed" && !id.empty()) {
    return close(told, id);
  } else if ((type == "incident_opened" || type == "incident_changed") && !id.empty()) {
    return take(told, id, type);
  }
  note(told, type);
}

// An event of one of its rules belongs to the incident.
void IncidentReader::note(const Told& told, const std::string& type) {
  const std::string rule = journal::text_of(told.event, "rule");
  if (rule.empty()) return;
  for (auto& [id, open] : open_) {
    Incident& incident = all_[open.place];
    if (std::ranges::find(incident.rules, rule) == incident.rules.end()) continue;
    incident.last_row = told.row;
    incident.seconds = std::max(incident.seconds, told.robot - open.robot_began);
    if (type == "failure_resolved")
      add_to(incident.helped, journal::text_of(told.event, "strategy"));
  }
}

IncidentReader::Open& IncidentReader::opened(const Told& told, const std::string& id,
                                             const std::string& type) {
  const auto known = open_.find(id);
  if (known != open_.end()) return known->second;
  if (type == "incident_changed") begun_before_.insert(id);
  const double age = kSecondsInNanosecond * static_cast<double>(std::max<std::int64_t>(
                                                0, journal::integer_of(told.event, "age_ns")));
  Incident incident;
  incident.id = id;
  incident.first_row = told.row;
  incident.began = told.wall - age;
  all_.push_back(std::move(incident));
  return open_.emplace(id, Open{all_.size() - 1, told.robot - age}).first->second;
}

void IncidentReader::take(const Told& told, const std::string& id, const std::string& type) {
  Open& open = opened(told, id, type);
  Incident& incident = all_[open.place];
  const std::string root = journal::text_of(told.event, "rule");
  const auto components = names_at(told.event, "components");
  incident.last_row = told.row;
  incident.seconds = std::max(incident.seconds, told.robot - open.robot_began);
  incident.needs_person = journal::flag_of(told.event, "needs_person");
  incident.criticality = criticality_of(told.event);
  incident.worst = std::max(incident.worst, incident.criticality);
  incident.is_given_up |= journal::flag_of(told.event, "exhausted");
  add_to(incident.rules, root);
  const auto explained = names_at(told.event, "consequences");
  for (const std::string& each : explained) {
    add_to(incident.rules, each);
    add_to(incident.consequences, each);
  }
  // The last failure that is left explains no other; what explained it is over.
  if (!explained.empty()) std::erase(incident.consequences, root);
  // Components of a rule alone are no cause.
  const bool is_certain = journal::flag_of(told.event, "certain");
  const bool is_known = is_certain || journal::flag_of(told.event, "suspected") ||
                        !journal::text_of(told.event, "condition").empty();
  if (is_certain != open.is_certain && is_certain) incident.causes.clear();
  if (is_certain || (is_known && !open.is_certain)) {
    for (const std::string& each : components) add_to(incident.causes, each);
  }
  open.is_certain |= is_certain;
  for (const std::string& each : incident.rules) {
    const auto row = detected_.find(each);
    if (row != detected_.end()) incident.first_row = std::min(incident.first_row, row->second);
  }
  for (const Loss& loss : losses_) {
    const bool is_its_own = std::ranges::find(components, loss.component) != components.end();
    if (is_its_own && loss.robot >= open.robot_began - kShortlyBefore)
      incident.first_row = std::min(incident.first_row, loss.row);
  }
}

void IncidentReader::close(const Told& told, const std::string& id) {
  const auto found = open_.find(id);
  if (found == open_.end()) return void(begun_before_.insert(id));
  Incident& incident = all_[found->second.place];
  incident.is_over = true;
  incident.needs_person = false;
  incident.last_row = told.row;
  incident.seconds = std::max(incident.seconds, told.robot - found->second.robot_began);
  incident.is_lost = journal::text_of(told.event, "how") == "lost";
  incident.merged_into = journal::text_of(told.event, "into");
  // Its failures may begin again under another id.
  for (const std::string& each : incident.rules) detected_.erase(each);
  open_.erase(found);
}

void IncidentReader::cut(double until) {
  for (const auto& [id, open] : open_) cut_off(all_[open.place], until);
  open_.clear();
  detected_.clear();
  losses_.clear();
}

}  // namespace culprit::incident_reports
