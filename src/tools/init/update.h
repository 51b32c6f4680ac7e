// A rule file, brought up to a robot that changed.
//
//   - A node, a diagnostic, a proposal or (with packs) a use that neither the file nor its marks know is added.
//   - A part that a draft wrote and no person changed is replaced if it no longer fits: a component with another start
//     command, a rule with other topics, a rule or proposal with limits near the measurements or far from them, and a
//     list of omissions that differs.
//   - All other lines stay, with their layout: those that a person wrote, changed or removed, and those about a node
//     that is missing now, which may only have failed.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "init/draft.h"
#include "language/rule_set.h"

namespace culprit::init {

struct Update {
  // `removed` lines of the file from line `at` (from 0) on give way to `added`, which are whole lines. Ascending.
  struct Change {
    std::size_t at = 0;
    std::size_t removed = 0;
    std::vector<std::string> added{};
  };
  std::vector<Change> changes{};
  std::vector<std::string> notes{};  // what stays as it is though it does not fit
};

// `text` is the file as it is written, `rules` what it stands for with all that it includes.
Update update(const std::string& text, const RuleSet& rules, const RobotProfile& seen, Packs packs);

}  // namespace culprit::init
