// A recording as rules see it, for Foxglove: an MCAP file that is opened beside the recording, and a layout for both.
//
// All messages are JSON with a schema, at the times at which the recorder wrote what caused them:
//
//     /culprit/log                 foxglove.Log: one for each event
//     /culprit/incidents           culprit.Incident: when one opens, changes or closes
//     /culprit/rules/NAME          culprit.Rule: "ok" or "failing", when that changes
//     /culprit/signals/NAME        culprit.Value: each value that rules read; likewise levels/ and parameters/
//     /culprit/gaps/TOPIC          culprit.Value: seconds between messages of a topic whose rhythm rules read
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/expected.h"
#include "language/rule_set.h"
#include "plan/planner.h"

namespace culprit::incident_reports {

struct FoxgloveWish {
  std::filesystem::path bag;
  std::vector<std::filesystem::path> message_path{};  // as ros2::message_directories() gives them
  std::filesystem::path file;                         // that is written
};

// Errors: the bag cannot be read, or has no message; the file cannot be written.
Expected<void> write_foxglove(const RuleSet& rules, std::unique_ptr<const Planner> planner,
                              const FoxgloveWish& wish);

// A plot for each signal with its limits, the states of rules, the incidents, and the log. Foxglove imports it.
std::string foxglove_layout(const RuleSet& rules);

// "out.mcap": "out.layout.json".
std::filesystem::path layout_beside(const std::filesystem::path& file);

}  // namespace culprit::incident_reports
