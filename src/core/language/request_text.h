// Judges the request of a `call` as far as that is possible without the type of its service: whether
// it is YAML that names fields. A live robot's link compares the fields with the type.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace culprit {

struct RequestFlaw {
  std::string cause;   // one line
  std::string remedy;  // one line
};

// The first flaw of the request; nothing if it has none, or if it is written in a way that only a
// parser of YAML can judge (block texts, anchors). An empty request has no flaw.
std::optional<RequestFlaw> flaw_of_request(std::string_view yaml);

}  // namespace culprit
