// The words of other tools (alerting, behaviour trees, compose files) for what this language calls
// otherwise: people write them first. Each gives our word; empty: it is no such word.
#pragma once

#include <string_view>

namespace culprit {

// `word` in upper case: "ALERT" -> "RULE".
std::string_view statement_of_other_tools(std::string_view word);
// In any case: "exec" -> "LAUNCH".
std::string_view clause_of_other_tools(std::string_view word);
// In lower case: "reboot" -> "redeploy".
std::string_view adaptation_of_other_tools(std::string_view word);

}  // namespace culprit
