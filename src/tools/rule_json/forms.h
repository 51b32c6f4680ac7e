// The statements of the rule language as JSON sees them: which words a line is made of, and what
// members its parts become (docs/rule-json.md).
//
// One table for both directions, so that what is written can be read.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace culprit::rule_json {

// A part of a line, and its JSON.
enum class Part : std::uint8_t {
  kWord,        // an identifier: a string
  kType,        // one of the form's types: a string
  kName,        // a name of any kind: a string
  kNames,       // names up to the end of the line: an array of strings
  kNodes,       // one name, or several that follow each other: a string, or an array of strings
  kNamePair,    // two names, one behind the other: an array of two strings
  kText,        // a quoted text: a string
  kNumber,      // not negative: a number
  kDuration,    // a string
  kExpression,  // a string
  kHold,        // n/k: an array of two numbers
  kRange,       // low..high: an array of two numbers
  kParameters,  // (a, b = 1): an array of strings, and of {"name", "usual"}
  kArguments,   // (a, b): an array of names
  kBraced,      // { a, b }: an array of identifiers
  kFlag         // nothing but the word: true
};

struct Clause {
  std::string_view word;  // in front; empty: none
  std::string_view member;
  Part part;
};

// One way to write a statement.
struct Form {
  std::string_view keyword;
  std::vector<Clause> fixed;  // all of them, in this order
  std::vector<Clause> free;   // behind those, each or not, in any order
  std::vector<std::string_view> types;
};

// The word that may stand in front of this keyword, and the member that says so.
inline constexpr std::string_view kStepKeyword = "ADAPTATION";
inline constexpr Clause kStep{"THEN", "then", Part::kFlag};

// Statements of one keyword follow each other.
std::span<const Form> forms();

}  // namespace culprit::rule_json
