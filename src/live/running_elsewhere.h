// Components whose nodes run on another computer, or ran there last. culprit starts none of them here by its LAUNCH:
// the process there may go on, and there would be two.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "robot/observation.h"

namespace culprit::live {

class RunningElsewhere {
 public:
  // `own_host`: the name of this computer. A node of it whose process is not known runs here.
  explicit RunningElsewhere(std::string own_host) : own_host_(std::move(own_host)) {}

  // An earlier run saw it there last (KnownRobot). This one's own sight counts more.
  void remember(ComponentId component, const std::string& host) {
    if (!host.empty() && host != own_host_ && !here_.contains(component))
      hosts_.try_emplace(component, host);
  }
  // Its node is in this process of this computer.
  void runs_here(ComponentId component, int pid) {
    here_[component] = pid;
    hosts_.erase(component);
  }

  void observe(const Observation& observation) {
    if (const auto* lives = std::get_if<LivesOn>(&observation.what)) {
      hosts_.erase(lives->component);
      if (!lives->host.empty() && lives->host != own_host_) hosts_[lives->component] = lives->host;
    } else if (const auto* process = std::get_if<ProcessSeen>(&observation.what)) {
      // It was started from here, as by LAUNCH "ssh ...". Not so where a person moved the node: its process here may
      // end last.
      const auto here = here_.find(process->component);
      const bool had_node = here != here_.end() && here->second == process->pid;
      if (process->state == ProcessState::kGone && !had_node) hosts_.erase(process->component);
    }
  }

  // Its host; empty: this computer, or not known.
  std::string host_of(ComponentId component) const {
    const auto found = hosts_.find(component);
    return found == hosts_.end() ? "" : found->second;
  }

 private:
  const std::string own_host_;
  std::map<ComponentId, std::string> hosts_;
  std::map<ComponentId, int> here_;  // the process that its node was in last
};

}  // namespace culprit::live
