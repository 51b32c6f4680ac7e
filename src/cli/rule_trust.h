// Who could change what culprit starts? A rule file's LAUNCH commands run as culprit's user, so
// nobody but that user and root may be able to write the file, or put another one in its place.
#pragma once

#include <string>

#include "language/rule_set.h"

namespace culprit::cli {

// Errors, for rules with launch commands only: the file or a folder above it belongs to somebody
// else, or is writable for its group or for all. A group that is its owner's alone, as Debian gives
// each user one, is no other; in a folder with the sticky bit, such as /tmp, nobody replaces what
// is not his own.
Expected<void> trust_launches(const RuleSet& rules, const std::string& path);

}  // namespace culprit::cli
