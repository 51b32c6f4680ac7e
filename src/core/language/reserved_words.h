// The words of the language that are no names.
#pragma once

#include <span>
#include <string_view>

namespace culprit {

// The words that nothing can be named by.
std::span<const std::string_view> reserved_words();
bool is_reserved(std::string_view word);

// They cannot be confused with a name where one may stand, so they are not reserved.
bool is_word_of_reuse(std::string_view word);

// Such a word cannot be a name: a reserved one, or a value.
bool is_word_of_language(std::string_view word);

}  // namespace culprit
