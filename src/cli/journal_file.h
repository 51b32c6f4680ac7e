// Which journal a command is about, and its rows for people.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "journal/reader.h"
#include "json/json.h"

namespace culprit::cli {

// The option --journal FILE. Without it the only journal of the default folder is meant.
struct JournalOption {
  std::string path;

  void add_to(CLI::App& command);
  Expected<std::filesystem::path> file() const;
  Expected<journal::Reader> open() const;
};

// "2026-11-21 18:36:01.123", by the clock of this machine. `at`: nanoseconds since 1970.
std::string local_time(std::int64_t at);
// "2026-11-21T17:36:01.123Z"
std::string utc_time(std::int64_t at);

// "   123  2026-11-21 18:36:01.123  strategy chosen    camera is held responsible …"; empty for an
// event that has nothing to say to people.
std::string log_line(const journal::Entry& entry);
// {"id", "at": "2026-11-21T17:36:01.123Z", "kind", "body"}
Json log_document(const journal::Entry& entry);

}  // namespace culprit::cli
