// Text for a terminal.
#pragma once

#include <cstddef>
#include <string>

namespace culprit {

// `text` in lines of at most so many bytes, where its words allow it. Its own line ends stay.
std::string wrapped(const std::string& text, std::size_t columns);

}  // namespace culprit
