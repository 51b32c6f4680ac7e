// The decisions that rules would have made about a recorded bag.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "terminal/planner_options.h"

namespace culprit::cli {

struct BagReplay {
  std::string bag;
  std::string rules;
  std::vector<std::filesystem::path> message_path;
  PlannerOptions planner;
};

// Prints the decisions; gives the exit code.
int replay_bag(const BagReplay& options);

}  // namespace culprit::cli
