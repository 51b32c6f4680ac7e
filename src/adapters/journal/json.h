// The rows of the journal as JSON (docs/journal.md): by name, so that they can be read without the
// rule file, and after the rule file has changed. Events: event_json.h.
#pragma once

#include <string>
#include <string_view>

#include "base/expected.h"
#include "json/json.h"
#include "json/json_writer.h"
#include "robot/command.h"

namespace culprit::journal {

// Members that may be missing, or be of another kind than expected.
std::string text_of(const Json& json, const char* key);
double number_of(const Json& json, const char* key, double otherwise = 0);
std::int64_t integer_of(const Json& json, const char* key, std::int64_t otherwise = 0);
bool flag_of(const Json& json, const char* key);

// The request of a command: {"set_parameter": {"name": "gain", "value": 0.5}}
void write(const decltype(Command::what)& request, JsonWriter& json);
Expected<decltype(Command::what)> request_from_json(const Json& json);

// The value that was read before a change, or with a reply: a value, {"lifecycle": "active"}, or
// null.
void write(const decltype(Reply::value)& value, JsonWriter& json);
decltype(Reply::value) reading_from_json(const Json& json);

std::string_view to_string(Outcome outcome);
std::optional<Outcome> outcome_from(std::string_view word);

}  // namespace culprit::journal
