// Characters of UTF-8 in bytes that may be anything.
#pragma once

#include <cstddef>
#include <string_view>

namespace culprit {

// The bytes of the character at the front of `text`; 0 if there is none: no UTF-8 has overlong forms, surrogates or
// more than U+10FFFF. @pre !text.empty()
std::size_t character_length(std::string_view text);

}  // namespace culprit
