// The decisions that rules would have made about a recorded bag.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "terminal/planner_options.h"

namespace culprit::cli {

struct BagReplayOptions {
  std::string bag;
  std::string rules;
  std::vector<std::filesystem::path> message_path;
  std::string since;    // a duration before the end; empty: all
  bool json = false;    // one document
  std::string fail_on;  // "error", "warning", "unjudged", "never"; empty: what cannot be read
  PlannerOptions planner;
  std::string html{};  // also as a page, in this file; empty: none
  std::string mcap{};  // likewise for Foxglove, with its layout beside it
};

// Prints what happens, and a line for each rule; gives the exit code.
int replay_bag(const BagReplayOptions& options);

}  // namespace culprit::cli
