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

// The remedy for a word that the language has in no form, in any case: "remove it: a signal has no unit". `line`: the
// statement that it stands in, as "SIGNAL"; empty: it begins a line.
std::string_view remedy_of_foreign_word(std::string_view word, std::string_view line);
// The same for a function, in lower case: "len".
std::string_view remedy_of_foreign_function(std::string_view word);

// Our own: the statement whose line has the clause, in any case: "FOR" -> "POLICIES".
std::string_view statement_of_clause(std::string_view word);

}  // namespace culprit
