// How names, texts and numbers are spelled: in JSON, and in a rule file.
//
// JSON holds what a name or number is. Where a file spells it in another way than this would be
// written back, JSON holds the spelling: a name or text with its quotes, a number as a string.
#pragma once

#include <string>
#include <string_view>

#include "json/json.h"

namespace culprit::rule_json {

// A text of the language: in quotes, with escapes.
std::string in_quotes(std::string_view value);
// A name as it is written: as it is, or in quotes where it would be read otherwise.
std::string spelled(std::string_view name);

// The JSON of `text`, a quoted text or a name of a rule file.
Json text_to_json(std::string_view text);
Json name_to_json(std::string_view text);
// The JSON of `text`, a number that may have a sign.
Json number_to_json(const std::string& text);

// Whether `text` is a whole and proper one, and nothing else. None holds the end of a line.
bool is_word(std::string_view text);
bool is_name(std::string_view text);
bool is_text(std::string_view text);
bool is_number(std::string_view text);
bool is_duration(std::string_view text);

}  // namespace culprit::rule_json
