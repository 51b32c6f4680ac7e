// A rule file, brought up to a robot that changed.
//
//   - A node, a diagnostic, (with packs) a use or a proposal that neither the file nor its marks know is added.
//   - What a draft wrote and nobody changed is replaced if it no longer fits: a component that is started
//     otherwise, a rule whose topics are others, or whose limits are near what was measured or far from it; a
//     proposal likewise; the list of what was left out if there is something else in it.
//   - All else stays, with its layout: what a person wrote, changed or took away, and what is about a
//     node that is not there now, which may only be ill.
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
Update update(const std::string& text, const RuleSet& rules, const Sighting& seen, Packs packs);

}  // namespace culprit::init
