#include "culprit_bt/health.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "behaviortree_cpp/exceptions.h"
#include "culprit_msgs/msg/component.hpp"
#include "culprit_msgs/msg/incident.hpp"

namespace culprit_bt {
namespace {

using culprit_msgs::msg::Component;
using culprit_msgs::msg::Status;
using Fault = culprit_msgs::msg::Incident;  // Incident is a leaf here

// How many letters have to be changed (Levenshtein).
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({changed, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

std::string no_such(const std::string& component, const Status& status) {
  std::string text = "culprit's rules have no component '" + component + "'";
  const Component* near = nullptr;
  std::size_t least = std::max<std::size_t>(1, component.size() / 3) + 1;
  for (const Component& each : status.components) {
    if (const std::size_t far = distance(component, each.name); far < least) {
      least = far;
      near = &each;
    }
  }
  return near == nullptr ? text : text + "; did you mean '" + near->name + "'?";
}

bool names(const Fault& incident, const std::string& component) {
  return component.empty() || std::find(incident.components.begin(), incident.components.end(),
                                        component) != incident.components.end();
}

// The worst open incident that is about it; they stand in that order.
const Fault* incident_of(const Status& status, const std::string& component,
                         std::uint8_t tolerated) {
  const auto found =
      std::find_if(status.incidents.begin(), status.incidents.end(), [&](const Fault& each) {
        return each.state == Fault::STATE_OPEN && each.health > tolerated && names(each, component);
      });
  return found == status.incidents.end() ? nullptr : &*found;
}

// The trouble of a component; empty: none.
std::string ill(const Component& component, std::uint8_t tolerated) {
  const std::string& name = component.name;
  if (!component.adapting.empty()) return name + " is changed by strategy " + component.adapting;
  if (component.process == Component::PROCESS_STOPPED)
    return "the process of " + name + " is stopped";
  if (component.process == Component::PROCESS_HUNG) return name + " hangs";
  if (component.process == Component::PROCESS_GONE) return "the process of " + name + " has ended";
  if (!component.is_present) return "the node of " + name + " is not there";
  if (component.health > tolerated) return "a rule that fails touches " + name;
  return "";
}

std::string told(const Fault& incident) {
  return incident.doing.empty() ? incident.headline : incident.headline + ": " + incident.doing;
}

}  // namespace

std::uint8_t tolerated(const std::string& word) {
  if (word == "OK") return Component::HEALTH_OK;
  if (word == "NON_CRITICAL") return Component::HEALTH_NON_CRITICAL;
  if (word == "WARNING") return Component::HEALTH_WARNING;
  throw BT::RuntimeError("tolerate is '", word, "': write OK, NON_CRITICAL or WARNING");
}

Health health_of(const Knowledge& known, const std::string& component, std::uint8_t tolerated) {
  if (!known.status) return {Outlook::kUnknown, known.why_not};
  const Status& status = *known.status;
  if (!status.hears)
    return {Outlook::kUnknown,
            "culprit receives nothing from the robot, so nothing is known of it"};
  bool is_there = component.empty();
  for (const Component& each : status.components) {
    if (!component.empty() && each.name != component) continue;
    is_there = true;
    std::string wrong = ill(each, tolerated);
    if (wrong.empty()) continue;
    const Fault* incident = incident_of(status, each.name, tolerated);
    return {Outlook::kIll, incident == nullptr ? wrong : told(*incident)};
  }
  if (!is_there) return {Outlook::kNoSuchComponent, no_such(component, status)};
  if (component.empty() && status.health > tolerated) {
    const Fault* incident = incident_of(status, "", tolerated);
    return {Outlook::kIll, incident == nullptr ? status.summary : told(*incident)};
  }
  return {Outlook::kWell, ""};
}

Health incident_at(const Knowledge& known, const std::string& component, std::uint8_t tolerated) {
  Health health = health_of(known, component, tolerated);
  if (health.outlook != Outlook::kWell) return health;
  const Fault* incident = incident_of(*known.status, component, tolerated);
  if (incident == nullptr) return health;
  return {Outlook::kIll, told(*incident)};
}

}  // namespace culprit_bt
