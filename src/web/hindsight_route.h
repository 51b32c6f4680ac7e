// The call that asks what rules would have done in the last while, had they run: a replay of the journal.
#pragma once

#include <filesystem>
#include <functional>

#include "http/routes.h"

namespace culprit::web {

// Which journal is meant, for the rules that were sent. Errors: there is none, and why.
using JournalOf = std::function<Expected<std::filesystem::path>(const std::string& rules)>;

Route hindsight_route(JournalOf journal_of);

// Of the robot that the rules name, where culprit run writes it unless it is said otherwise.
Expected<std::filesystem::path> usual_journal(const std::string& rules);

}  // namespace culprit::web
