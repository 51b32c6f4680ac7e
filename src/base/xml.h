// Any bytes as text of an XML 1.0 or HTML document.
#pragma once

#include <string>
#include <string_view>

namespace culprit {

// For an element's content or an attribute in double quotes. Each byte that XML does not allow even
// escaped (control characters, bytes that are no UTF-8) becomes '?'.
std::string xml_escaped(std::string_view text);

}  // namespace culprit
