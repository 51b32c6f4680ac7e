// A recording as its rules judge it, in one HTML file that needs nothing else: its incidents, and then, as on an incident's page
// (incident_page.h), its timeline, events, and curves with limits and marks.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/expected.h"
#include "language/rule_set.h"
#include "plan/planner.h"

namespace culprit::incident_reports {

struct BagPageWish {
  std::filesystem::path bag;
  std::vector<std::filesystem::path> message_path{};  // as ros2::message_directories() gives them
  double written_at = 0;                              // seconds since 1970
};

// Errors: the bag cannot be read, or has no message.
Expected<std::string> bag_page(const RuleSet& rules, std::unique_ptr<const Planner> planner,
                               const BagPageWish& wish);

}  // namespace culprit::incident_reports
