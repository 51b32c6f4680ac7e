// A demonstration's fault: one of the exemplar's scenarios, or a fault of processes.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/expected.h"
#include "exemplars/sunset/sunset_scenario.h"

namespace culprit::lab {

struct Play {
  std::string name;
  std::vector<const sunset::Fault*> faults;
  std::vector<std::pair<sunset::ProcessFault, sunset::Member>> process_faults;

  // "camera_driver_issue", "kill camera"
  std::vector<std::string> fault_names() const;
  // How many of its faults nothing but a redeployment ends.
  int redeployments_needed() const;
};

// An exemplar's scenario by label or name ("001", "image_shift+gpu_failure"); "kill:camera",
// "stop:depth", "crash:segmentation" (killed, and its next two starts fail), also of several nodes
// at once: "kill:camera+segmentation".
Expected<Play> find_play(std::string_view name);

// The default plays of `culprit demo`: an ERROR, a WARNING and a NON_CRITICAL fault at once, three
// times.
std::vector<Play> default_plays();

}  // namespace culprit::lab
