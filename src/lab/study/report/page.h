// The frame of every report: a page that needs no network, no fonts and no other file, and follows
// the reader's preference for light or dark.
#pragma once

#include <string>
#include <string_view>

namespace culprit::study {

// Up to and without <body>.
std::string page_head(const std::string& title);

// An entry of a <dl class="facts">.
std::string page_fact(std::string_view name, const std::string& value_html);

}  // namespace culprit::study
