// The call that asks what rules would have done in the last while, had they run: a replay of the journal.
#pragma once

#include <filesystem>
#include <functional>

#include "http/routes.h"

namespace culprit::web {

// Which journal is meant, for the rules that were sent. Errors: there is none, and why.
using JournalOf = std::function<Expected<std::filesystem::path>(const std::string& rules)>;

Route hindsight_route(JournalOf journal_of);

// The journal of the robot that the rules name, at the default path of culprit run.
Expected<std::filesystem::path> usual_journal(const std::string& rules);

}  // namespace culprit::web
