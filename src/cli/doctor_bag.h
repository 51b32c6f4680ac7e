// Finds problems in recordings, without rules.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace culprit::cli {

struct BagExamination {
  std::vector<std::string> bags;
  std::string graph;         // as `culprit graph --json` writes it; empty: none
  std::string rules;         // whose declarations say who depends on whom; empty: none
  std::string policy;        // empty: none
  std::string fail_on = "";  // "error", "warning", "never"; empty: as the doctor of live robots
  std::vector<std::filesystem::path> message_path;
  bool json = false;
  bool sarif = false;
};

// Prints the findings; gives the exit code.
int examine_bags(const BagExamination& options);

}  // namespace culprit::cli
