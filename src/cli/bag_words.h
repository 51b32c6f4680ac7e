// Words that all commands have for bags: times, and troubles.
#pragma once

#include <cstdint>
#include <string>

#include "bag/bag_file.h"
#include "json/json.h"

namespace culprit::cli {

// `at`, in nanoseconds since 1970, as "2026-11-21 18:36:01.123" by the clock of this machine, and
// "2026-11-21T17:36:01.123Z".
std::string clock_text(std::int64_t at);
std::string clock_document(std::int64_t at);

// "the clock was set back by 3600.000 s at 15.000 s (2026-11-21 17:36:01.123)". `start`: of the
// recording, as BagMessage::at.
std::string describe(const bag::ClockJump& jump, std::int64_t start);

// Jumps of the clock, files that are no part of the recording, and what cannot be read, a line each
// on stderr; and as members of a document.
void print_bag_troubles(const bag::BagFile& bag, std::int64_t start);
void add_bag_troubles(Json& document, const bag::BagFile& bag, std::int64_t start);

}  // namespace culprit::cli
