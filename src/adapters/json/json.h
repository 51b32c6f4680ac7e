// JSON documents, read from text and written as text. Here alone, for the library's parser takes
// seconds to compile wherever it is called.
//
//     const Json answer = parse_json(R"({"node": "/camera", "pid": 42})");
//     if (answer.is_discarded()) …       // it is no JSON
//     to_line({{"node", "/camera"}})     // {"node":"/camera"}
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace culprit {

using Json = nlohmann::ordered_json;  // members stay in the order in which they were written

// Never throws; discarded if `text` is no JSON.
Json parse_json(std::string_view text);
// As above, for text from an untrusted peer. Also discarded if an object has a member twice, since
// readers disagree which of the two counts. Also if more than 100 lists and objects are nested,
// which to_line() could not write.
Json parse_strict_json(std::string_view text);

// Neither throws: bytes that are no UTF-8 are replaced, for robots use any bytes in names.
std::string to_line(const Json& json);      // on one line
std::string to_indented(const Json& json);  // on several, without a newline at the end

}  // namespace culprit
