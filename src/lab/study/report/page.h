// What every report begins with: a page that needs nothing else, no network, no fonts, no other
// file, and follows the reader's preference for light or dark.
#pragma once

#include <string>
#include <string_view>

namespace culprit::study {

// Up to and without <body>.
std::string page_head(const std::string& title);

// An entry of a <dl class="facts">.
std::string page_fact(std::string_view name, const std::string& value_html);

}  // namespace culprit::study
