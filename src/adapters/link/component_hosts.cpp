#include "link/component_hosts.h"

#include "base/live_clock.h"
#include "base/name_grammar.h"

namespace culprit::link {

void ComponentHosts::on_discovery(const ros2::DiscoveryEvent& event) {
  if (const auto* info = std::get_if<ros2::ParticipantInfo>(&event)) {
    hosts_.joined(info->guid.prefix(), printable(info->host), is_on_this_machine(*info));
  } else if (const auto* gone = std::get_if<ros2::ParticipantGone>(&event)) {
    hosts_.left(gone->guid.prefix(), gone->was_lost, live_now());
  }
}

void ComponentHosts::node_joined(const std::string& node, const std::string& host) {
  const MutexLock lock(mutex_);
  nodes_elsewhere_.erase(node);
  if (!host.empty()) nodes_elsewhere_.emplace(node, host);
}

void ComponentHosts::node_left(const std::string& node) {
  const MutexLock lock(mutex_);
  nodes_elsewhere_.erase(node);
}

void ComponentHosts::lives_on(ComponentId component, const std::string& host) {
  {
    const MutexLock lock(mutex_);
    const auto found = elsewhere_.find(component);
    if ((found == elsewhere_.end() ? "" : found->second) == host) return;
    elsewhere_.erase(component);
    if (!host.empty()) elsewhere_[component] = host;
  }
  inbox_.put(LivesOn{component, host});
}

std::vector<ComponentId> ComponentHosts::look(Time now) {
  std::vector<ComponentId> silent;
  const MutexLock lock(mutex_);
  std::set<std::string> hosts = silent_hosts_;
  for (const auto& [component, host] : elsewhere_) hosts.insert(host);
  for (const std::string& host : hosts) {
    const bool is_silent = hosts_.is_silent(host, now);
    const bool is_news =
        is_silent ? silent_hosts_.insert(host).second : silent_hosts_.erase(host) > 0;
    if (is_news) inbox_.put(HostHeard{host, !is_silent});
    for (const auto& [component, where] : elsewhere_) {
      if (is_silent && where == host) silent.push_back(component);
    }
  }
  return silent;
}

std::string ComponentHosts::host_of(ComponentId component) const {
  const MutexLock lock(mutex_);
  const auto found = elsewhere_.find(component);
  return found == elsewhere_.end() ? "" : found->second;
}

std::optional<std::string> ComponentHosts::cut_off(ComponentId component) const {
  const MutexLock lock(mutex_);
  const auto found = elsewhere_.find(component);
  if (found == elsewhere_.end() || !silent_hosts_.contains(found->second)) return std::nullopt;
  return found->second;
}

std::map<std::string, std::string> ComponentHosts::nodes_elsewhere() const {
  const MutexLock lock(mutex_);
  return nodes_elsewhere_;
}

}  // namespace culprit::link
