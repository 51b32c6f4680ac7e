#include "incident_reports/older_incidents.h"

#include <algorithm>

#include "journal/json.h"

namespace culprit::incident_reports {
namespace {

constexpr double kShortly =
    2;  // s, from the loss of a component to the failure that it is a part of
constexpr std::size_t kMostLosses = 16;

bool is_any_of(const std::string& type, std::initializer_list<std::string_view> all) {
  return std::ranges::find(all, type) != all.end();
}

}  // namespace

void OlderIncidents::begin(const Told& told) {
  Incident incident;
  incident.first_row = told.row;
  incident.began = told.wall;
  incident.id = id_of_beginning(told.wall);
  robot_began_ = told.robot;
  is_blamed_ = false;
  for (const Loss& loss : losses_) {
    if (told.robot - loss.robot > kShortly) continue;
    incident.first_row = std::min(incident.first_row, loss.row);
    add_to(incident.causes, loss.component);
  }
  losses_.clear();
  all_.push_back(std::move(incident));
}

void OlderIncidents::add(const Told& told, const ComponentsOf& components_of) {
  const std::string type = journal::text_of(told.event, "type");
  const std::string rule = journal::text_of(told.event, "rule");
  if (type == "failure_detected") {
    if (failing_.empty()) begin(told);
    failing_.insert(rule);
  } else if (type == "component_lost" && failing_.empty()) {
    losses_.push_back({told.row, told.robot, journal::text_of(told.event, "component")});
    if (losses_.size() > kMostLosses) losses_.pop_front();
  } else if (!rule.empty() && !failing_.contains(rule) &&
             is_any_of(type, {"failure_resolved", "failure_lost", "strategy_failed",
                              "rule_exhausted", "round_spent"})) {
    begun_before_.insert(rule);
  }
  if (failing_.empty()) return;
  learn(told, type, components_of);
  if (type != "failure_resolved" && type != "failure_lost") return;
  failing_.erase(rule);
  if (failing_.empty()) end();
}

void OlderIncidents::learn(const Told& told, const std::string& type,
                           const ComponentsOf& components_of) {
  Incident& incident = all_.back();
  const std::string rule = journal::text_of(told.event, "rule");
  const std::string strategy = journal::text_of(told.event, "strategy");
  incident.last_row = told.row;
  incident.seconds = std::max(incident.seconds, told.robot - robot_began_);
  if (type == "failure_detected") {
    add_to(incident.rules, rule);
    incident.worst = std::max(incident.worst, criticality_of(told.event));
    incident.criticality = incident.worst;
  } else if (is_any_of(type, {"strategy_chosen", "approval_asked", "action_held_back"})) {
    if (!is_blamed_) incident.causes.clear();
    is_blamed_ = true;
    for (const std::string& component : components_of(rule, strategy))
      add_to(incident.causes, component);
  } else if (type == "component_lost" && !is_blamed_) {
    add_to(incident.causes, journal::text_of(told.event, "component"));
  } else if (type == "failure_resolved" && !strategy.empty()) {
    add_to(incident.helped, strategy);
  } else if (type == "rule_exhausted") {
    incident.is_given_up = incident.needs_person = true;
  } else {
    return;
  }
  incident.consequences.clear();
  for (const std::string& each : incident.rules) {
    const auto components = components_of(each, "");
    const bool is_about_cause = std::ranges::any_of(components, [&](const std::string& c) {
      return std::ranges::find(incident.causes, c) != incident.causes.end();
    });
    if (incident.causes.empty() ? each != incident.rules.front() : !is_about_cause)
      incident.consequences.push_back(each);
  }
}

void OlderIncidents::end() {
  all_.back().is_over = true;
  losses_.clear();
}

void OlderIncidents::cut(double until) {
  if (!failing_.empty()) cut_off(all_.back(), until);
  failing_.clear();
  losses_.clear();
}

}  // namespace culprit::incident_reports
