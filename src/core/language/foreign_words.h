// The words of other tools (alerting, behaviour trees, compose files) for what this language calls
// otherwise: people write them first. Each gives our word; empty: it is no such word.
#pragma once

#include <span>
#include <string_view>

namespace culprit {

// `word` in upper case: "ALERT" -> "RULE".
std::string_view statement_of_other_tools(std::string_view word);
// In any case: "exec" -> "LAUNCH". Only a clause of `known`.
std::string_view clause_of_other_tools(std::string_view word,
                                       std::span<const std::string_view> known);
// In lower case: "reboot" -> "redeploy".
std::string_view adaptation_of_other_tools(std::string_view word);
// In lower case: "hz" -> "rate"; "dead" -> "!alive".
std::string_view function_of_other_tools(std::string_view word);

// Our own: the statement whose line has the clause, in any case: "FOR" -> "POLICIES".
std::string_view statement_of_clause(std::string_view word);

}  // namespace culprit
