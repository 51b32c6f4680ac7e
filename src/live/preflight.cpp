#include "live/preflight.h"

#include <algorithm>
#include <iterator>
#include <map>

#include <fmt/core.h>

#include "base/ros_names.h"
#include "doctor/machine.h"
#include "link/service_call.h"
#include "live/robot_survey.h"
#include "live/setups.h"
#include "live_checks/live_checks.h"
#include "live_checks/live_findings.h"
#include "owners/found_owner.h"
#include "owners/launch_difference.h"
#include "owners/parameter_file.h"
#include "owners/plugin_index.h"
#include "owners/remote_program.h"
#include "owners/service_units.h"

namespace culprit::live {
namespace {

using namespace std::chrono_literals;

constexpr Duration kLook = 3s;

// Looks again and again. False if `end` came first, or it is to stop.
template <class Enough>
bool look_until(Enough is_enough, Time end, const std::stop_token& stop) {
  while (!is_enough()) {
    if (stop.stop_requested() || live_now() >= end) return false;
    std::this_thread::sleep_for(50ms);
  }
  return true;
}

std::string report(const Source& source, const RuleSet& rules, const LiveInventory& robot,
                   std::uint32_t domain) {
  const auto found = live_checks::findings(rules, robot);
  std::vector<Diagnostic> missing = live_checks::missing_on(robot, source);
  const auto others = std::stable_partition(
      missing.begin(), missing.end(),
      [](const Diagnostic& each) { return each.code != Code::kRunsOtherwise; });
  const std::vector<Diagnostic> runs_otherwise(others, missing.end());
  missing.erase(others, missing.end());
  std::string text = found.empty()
                         ? fmt::format("culprit: found nothing on domain {} that {} names\n",
                                       domain, source.name())
                         : fmt::format("culprit: {} names, and the robot on domain {} has:\n",
                                       source.name(), domain);
  for (const std::string& line : found) text += "  " + line + "\n";
  if (!missing.empty())
    text += fmt::format("culprit: named in {}, and not found on the robot:\n", source.name());
  for (const Diagnostic& each : missing) text += render(each, source);
  if (!runs_otherwise.empty())
    text += fmt::format("culprit: components run differently from {}:\n", source.name());
  for (const Diagnostic& each : runs_otherwise) text += render(each, source);
  return text;
}

class Look {
 public:
  // `source` must outlive it.
  static Expected<Look> open(const Source& source,
                             const std::vector<std::filesystem::path>& message_path) {
    const auto participant = ros2::options_from_environment();
    if (!participant) return Error{participant.error()};
    // Keys for what the rules need do not open all that a look takes.
    if (participant->security)
      return Error{"the domain is secured, so the rules are not compared with the robot"};
    auto survey = open_survey(message_path);
    if (!survey) return Error{"the rules cannot be compared with the robot: " + survey.error()};
    return Look(source, participant->domain, std::move(*survey));
  }

  Snapshot snapshot(const std::stop_token& stop) {
    const LiveInventory robot = look_for({&*checked_.rules}, *survey_, kLook, stop);
    if (!robot.has_robot()) return {false, "culprit: " + no_nodes_on(domain_) + "\n"};
    return {true, report(source_, *checked_.rules, robot, domain_)};
  }
  bool waits_for_robot(const std::stop_token& stop) {
    return look_until([&] { return survey_->inventory().has_robot(); }, kNever, stop);
  }

 private:
  Look(const Source& source, std::uint32_t domain, std::unique_ptr<link::Survey> survey)
      : source_(source), domain_(domain), survey_(std::move(survey)), checked_(check(source)) {}

  const Source& source_;
  std::uint32_t domain_;
  std::unique_ptr<link::Survey> survey_;
  Checked checked_;
};

}  // namespace

std::string no_nodes_on(std::uint32_t domain) {
  const auto others = doctor::other_domains(domain, {});
  return fmt::format("no nodes were seen on domain {}; is ROS_DOMAIN_ID the robot's?{}", domain,
                     others.empty() ? ""
                                    : " Processes of this machine are on " +
                                          doctor::domains_with_programs(others) + ".");
}

namespace {

// Finds the owners of components whose rules name none.
void find_owners(const RuleSet& rules, LiveInventory& robot) {
  for (const Component& component : rules.components) {
    const std::string node = robot.node_of(component);
    if (node.empty() || component.can_start_again()) continue;
    LiveInventory::Node& it = robot.nodes.at(node);
    std::string loader;
    for (const auto& [other, what] : robot.nodes) {
      if (other != node && what.pid == it.pid &&
          robot.services.contains(other + "/_container/load_node"))
        loader = other;
    }
    if (const auto owner = owners::found_owner(it.pid, loader))
      it.owner = owner->name + ": " + owner->declare;
  }
}

// Finds owners that do not answer.
void find_owner_troubles(const RuleSet& rules, const std::stop_token& stop, LiveInventory& robot) {
  std::map<std::string, bool> reached{{"", true}};
  for (const Component& component : rules.components) {
    if (stop.stop_requested()) return;
    if (!component.has_owner()) continue;
    const std::string host = component.host();
    if (const auto [asked, is_first] = reached.try_emplace(host, true); is_first) {
      const auto could = owners::could_reach(host);
      asked->second = could.has_value();
      if (!could) robot.host_troubles.push_back({host, could.error()});
    }
    if (!reached[host]) continue;
    if (component.engine) {
      if (const auto could = owners::could_manage(*component.engine); !could)
        robot.container_troubles.push_back({*component.engine, could.error()});
    }
    if (component.unit) {
      if (const auto could = owners::could_manage(*component.unit); !could)
        robot.unit_troubles.push_back({*component.unit, could.error()});
    }
  }
}

// Finds requests that cannot be made to the services of the robot.
void find_request_troubles(const RuleSet& rules, link::Survey& survey, const std::stop_token& stop,
                           LiveInventory& robot) {
  for (const Strategy& strategy : rules.strategies) {
    for (const Adaptation& each : strategy.adaptations) {
      const std::string node = robot.node_of(rules[each.component]);
      if (stop.stop_requested()) return;
      if (each.type != AdaptationType::kCall || node.empty()) continue;
      const auto service = robot.services.find(service_of(each.subject, node));
      if (service == robot.services.end()) continue;
      auto type = survey.find_service_type(service->first);
      const auto could = type ? link::ServiceCall::prepare(service->second, each.request, *type)
                              : Error{type.error()};
      if (!could) robot.request_troubles.push_back({service->first, each.request, could.error()});
    }
  }
}

// In what a component that runs differs from what its LAUNCH would start.
void find_launch_differences(const RuleSet& rules, LiveInventory& robot) {
  using Clause = LiveInventory::LaunchTrouble::Clause;
  for (const Component& component : rules.components) {
    const std::string node = robot.node_of(component);
    if (component.launch.empty() || node.empty()) continue;
    const int pid = robot.nodes.at(node).pid;
    const auto process = pid == 0 ? std::nullopt : owners::running_process(pid);
    if (!process) continue;
    for (const std::string& each :
         owners::launch_differences(component.launch, component.folder, node, *process))
      robot.launch_troubles.push_back({component.name, Clause::kRunning, component.launch.front(),
                                       component.name + " " + each});
  }
}

// Finds components that their running container could not load.
void find_composition_troubles(const Component& component, LiveInventory& robot) {
  using Clause = LiveInventory::LaunchTrouble::Clause;
  const Composition& how = *component.composed;
  const auto container = robot.nodes.find(how.container);
  if (container != robot.nodes.end() && container->second.pid != 0) {
    const auto found = owners::find_plugin(container->second.pid, how.package, how.plugin);
    if (!found)
      robot.launch_troubles.push_back(
          {component.name, Clause::kPlugin, how.plugin, "PLUGIN: " + found.error()});
  }
  if (how.parameters.empty()) return;
  if (const auto read = owners::read_parameter_file(how.parameters, component.node); !read)
    robot.launch_troubles.push_back(
        {component.name, Clause::kParameters, how.parameters, read.error()});
}

}  // namespace

LiveInventory look_for(const std::vector<const RuleSet*>& rules, link::Survey& survey,
                       Duration wait, const std::stop_token& stop) {
  LiveInterest interest;
  for (const RuleSet* each : rules) {
    LiveInterest more = interest_of(*each);
    interest.nodes.merge(more.nodes);
    for (auto& [topic, fields] : more.fields_of_topics)
      interest.fields_of_topics[topic].merge(fields);
  }
  survey.ask_for(std::move(interest));
  const auto all_found = [&] {
    const LiveInventory robot = survey.inventory();
    return std::all_of(rules.begin(), rules.end(), [&](const RuleSet* each) {
      return live_checks::is_all_found(*each, robot);
    });
  };
  look_until(all_found, later(live_now(), wait), stop);
  LiveInventory robot = survey.inventory();
  for (const RuleSet* each : rules) {
    find_owners(*each, robot);
    find_owner_troubles(*each, stop, robot);
    find_launch_differences(*each, robot);
    find_request_troubles(*each, survey, stop, robot);
    for (const Component& component : each->components) {
      if (stop.stop_requested()) break;
      if (component.composed) find_composition_troubles(component, robot);
    }
    std::ranges::move(launch_troubles(*each, stop), std::back_inserter(robot.launch_troubles));
  }
  return robot;
}

Expected<Snapshot> take_snapshot(const Source& source,
                                 const std::vector<std::filesystem::path>& message_path) {
  auto look = Look::open(source, message_path);
  if (!look) return Error{look.error()};
  return look->snapshot({});
}

Preflight::Preflight(Source rules, std::vector<std::filesystem::path> message_path,
                     std::function<void(const std::string&)> say)
    : source_(std::move(rules)),
      message_path_(std::move(message_path)),
      say_(std::move(say)),
      thread_([this](const std::stop_token& stop) { look(stop); }) {}

void Preflight::look(const std::stop_token& stop) const {
  auto look = Look::open(source_, message_path_);
  if (!look) return say_("culprit: " + look.error() + "\n");
  Snapshot seen = look->snapshot(stop);
  if (!seen.has_robot && !stop.stop_requested()) {
    say_(seen.report + "culprit: waiting for the robot\n");
    if (!look->waits_for_robot(stop)) return;
    seen = look->snapshot(stop);
  }
  if (!stop.stop_requested()) say_(seen.report);
}

}  // namespace culprit::live
