#include "link/rights.h"

#include <algorithm>

#include "base/invariant.h"
#include "base/ros_names.h"
#include "link/component_needs.h"
#include "link/diagnostics_reading.h"
#include "link/manager_lease.h"
#include "ros2/discovery_info.h"
#include "ros2/hearing.h"

namespace culprit::link {
namespace {

// Any other text that a rule file gives as a service could not be called either.
bool is_name_or_pattern(std::string name) {
  std::replace(name.begin(), name.end(), '*', '_');
  return is_valid_topic_name(name);
}

void tidy(std::vector<std::string>& names) {
  std::erase_if(names, [](const std::string& name) { return !is_name_or_pattern(name); });
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
}

// The full names that the component's node may have.
std::vector<std::string> nodes_of(const Component& component) {
  if (!component.node.empty()) return {component.node};
  return {"/" + component.name, "/*/" + component.name};
}

void add(ComponentId component, const RuleSet& rules, Rights& rights) {
  const ComponentNeeds needs = needs_of(component, rules);
  for (const std::string& other : rules[component].other_nodes)
    rights.calls.push_back(other + "/get_parameters");
  for (const std::string& node : nodes_of(rules[component])) {
    rights.subscribes.push_back(node + "/transition_event");
    rights.calls.push_back(node + "/get_state");
    rights.calls.push_back(node + "/get_parameters");
    if (needs.changes_lifecycle) rights.calls.push_back(node + "/change_state");
    if (needs.sets_parameters) rights.calls.push_back(node + "/set_parameters");
    if (needs.changes_modes) {
      rights.calls.push_back(node + "/change_mode");
      rights.calls.push_back(node + "/get_mode");
    }
    for (const std::string& routine : needs.routines)
      rights.calls.push_back(service_of(routine, node));
  }
}

void list(std::string& xml, const std::string& indent, const char* element,
          const std::vector<std::string>& names) {
  for (const std::string& name : names)
    xml += indent + "<" + element + ">" + name + "</" + element + ">\n";
}

void profile(std::string& xml, const char* kind, const char* verb, const char* element,
             const std::vector<std::string>& names) {
  if (names.empty()) return;
  const std::string group = kind;
  xml += "          <" + group + " " + verb + "=\"ALLOW\">\n";
  list(xml, "            ", element, names);
  xml += "          </" + group + ">\n";
}

// As ROS 2 has them on DDS. Patterns are kept.
std::vector<std::string> mangled(ros2::Channel channel, const std::vector<std::string>& names) {
  std::vector<std::string> all;
  all.reserve(names.size());
  for (const std::string& name : names) all.push_back(ros2::mangle_topic(channel, name));
  return all;
}

void criteria(std::string& xml, const char* verb, std::vector<std::vector<std::string>> parts) {
  std::vector<std::string> names{std::string(ros2::kDiscoveryInfoTopic)};
  for (std::vector<std::string>& part : parts) names.insert(names.end(), part.begin(), part.end());
  std::sort(names.begin(), names.end());
  const std::string element = verb;
  xml += "        <" + element + ">\n          <topics>\n";
  list(xml, "            ", "topic", names);
  xml += "          </topics>\n        </" + element + ">\n";
}

}  // namespace

Rights rights_of(const RuleSet& rules, const ros2::NodeName& self) {
  Rights rights;
  const auto lease = ros2::demangle_topic(ManagerLease::kTopic);
  const auto hearing = ros2::demangle_topic(ros2::Hearing::kTopic);
  rights.publishes = {"/diagnostics", "/parameter_events", "/rosout", lease->name, hearing->name};
  // Of ros_api/: its messages, and the orders that are taken.
  for (const char* topic :
       {"status", "incidents", "decisions", "wait_for_recovery/_action/feedback",
        "wait_for_recovery/_action/status"})
    rights.publishes.push_back(self.full() + "/" + topic);
  for (const char* service :
       {"get_type_description", "pause", "resume", "approve", "silence", "run_strategy",
        "wait_for_recovery/_action/send_goal", "wait_for_recovery/_action/cancel_goal",
        "wait_for_recovery/_action/get_result"})
    rights.offers.push_back(self.full() + "/" + service);
  rights.subscribes = {lease->name, hearing->name};
  for (const char* service : {"describe_parameters", "get_parameter_types", "get_parameters",
                              "list_parameters", "set_parameters", "set_parameters_atomically"})
    rights.offers.push_back(self.full() + "/" + service);
  for (const Topic& topic : rules.topics) rights.subscribes.push_back(topic.name);
  if (DiagnosticsReading(rules).is_wanted()) rights.subscribes.emplace_back("/diagnostics");
  const auto counts_logs = [](const Input& input) { return input.kind == Input::Kind::kLogs; };
  if (std::ranges::any_of(rules.inputs, counts_logs)) rights.subscribes.emplace_back("/rosout");
  if (!rules.parameters.empty()) rights.subscribes.emplace_back("/parameter_events");
  for (std::size_t c = 0; c < rules.components.size(); ++c) add(ComponentId(c), rules, rights);
  for (auto* names : {&rights.publishes, &rights.subscribes, &rights.offers, &rights.calls})
    tidy(*names);
  return rights;
}

std::string sros2_policy(const Rights& rights, const ros2::NodeName& self,
                         const std::string& enclave) {
  CULPRIT_ASSERT(is_valid_topic_name(enclave));
  std::string xml = "<policy version=\"0.2.0\">\n  <enclaves>\n    <enclave path=\"" + enclave +
                    "\">\n      <profiles>\n        <profile ns=\"" + self.name_space +
                    "\" node=\"" + self.name + "\">\n";
  profile(xml, "topics", "publish", "topic", rights.publishes);
  profile(xml, "topics", "subscribe", "topic", rights.subscribes);
  profile(xml, "services", "reply", "service", rights.offers);
  profile(xml, "services", "request", "service", rights.calls);
  return xml + "        </profile>\n      </profiles>\n    </enclave>\n  </enclaves>\n</policy>\n";
}

std::string permissions(const Rights& rights, const std::string& enclave, std::uint32_t domain,
                        const Validity& validity) {
  CULPRIT_ASSERT(is_valid_topic_name(enclave));
  std::string xml =
      "<dds xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\"\n"
      "     xsi:noNamespaceSchemaLocation=\"http://www.omg.org/spec/DDS-SECURITY/20170901/"
      "omg_shared_ca_permissions.xsd\">\n"
      "  <permissions>\n    <grant name=\"" +
      enclave + "\">\n      <subject_name>CN=" + enclave +
      "</subject_name>\n      <validity>\n        <not_before>" + validity.from +
      "</not_before>\n        <not_after>" + validity.to +
      "</not_after>\n      </validity>\n      <allow_rule>\n        <domains><id>" +
      std::to_string(domain) + "</id></domains>\n";
  criteria(xml, "publish",
           {mangled(ros2::Channel::kTopic, rights.publishes),
            mangled(ros2::Channel::kReply, rights.offers),
            mangled(ros2::Channel::kRequest, rights.calls)});
  criteria(xml, "subscribe",
           {mangled(ros2::Channel::kTopic, rights.subscribes),
            mangled(ros2::Channel::kRequest, rights.offers),
            mangled(ros2::Channel::kReply, rights.calls)});
  return xml +
         "      </allow_rule>\n      <default>DENY</default>\n    </grant>\n  </permissions>\n"
         "</dds>\n";
}

}  // namespace culprit::link
