// Text inside XML and HTML, and names of anchors, labels and files.
#pragma once

#include <string>
#include <string_view>

namespace culprit::study {

// For text and for values of attributes in quotes: what has a meaning there is spelled out, and
// control characters, which no document may hold, become U+FFFD.
std::string markup_escaped(std::string_view text);

// With a dash for whatever is no letter, digit, dash or underscore.
std::string safe_id(std::string text);

}  // namespace culprit::study
