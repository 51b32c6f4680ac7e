// Cases of the public benchmark as files that need nothing of culprit (cases_readme.md has their
// format; docs/study-rca.md).
//
//     README.md  score.py
//     public/case-0001/graph.json  signals.csv  events.csv  robot.rules  truth.json
//     hidden/case-0001/            the same without truth.json
//     hidden-truth.json            of all hidden cases
//     answers-bayes.json           of each adviser, on the public cases
//     hidden-answers-bayes.json    on the hidden ones
//     sunset/case-0001/            of other robots, as the public ones; sunset-answers-bayes.json
//     hidden-sunset/case-0001/     as the hidden ones; hidden-sunset-truth.json
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "plan/bayes/objective.h"
#include "rca_study/campaign.h"
#include "rca_study/cases.h"

namespace culprit::study::rca {

struct CaseExport {
  static constexpr std::size_t kMostCases = 9999;
  // So many robots in a row may not count before the export fails.
  static constexpr std::size_t kMostTries = 1000;

  std::vector<RcaSetting> settings;  // in turns
  std::size_t cases = 40;
  std::size_t hidden_cases = 20;             // if there is a hidden seed
  std::uint64_t seed = 1;                    // of the public cases
  std::optional<std::uint64_t> hidden_seed;  // it is in no file
  std::vector<std::string> advisers = {"bayes", "informed", "paper"};
  Objective objective = Objective::kBalanced;
  using Others = std::map<std::string, std::vector<RcaCase>>;  // by robot: "sunset"
  Others others{};                                             // public
  Others hidden_others{};
  std::string command;  // that makes the public cases, for README.md
};

// Told the path below the folder, and the content.
using WriteFile = std::function<Expected<void>(const std::string& path, const std::string& text)>;

// The same export gives the same files, in the same order. Asks `go_on` after each case. Errors: a
// file cannot be written, it was stopped, or no robot of a setting counts as a case.
Expected<void> export_cases(const CaseExport& wanted, const WriteFile& write, const GoOn& go_on);

}  // namespace culprit::study::rca
