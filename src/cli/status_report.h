// The state of a robot and its culprit in words for a terminal: failures, root causes, next steps. Made from a running culprit's own report (docs/web.md).
#pragma once

#include <string>
#include <vector>

#include "language/diagnostic.h"
#include "web/event_json.h"

namespace culprit::cli {

// The latest documents of GET /api/stream, and of /api/about. Documents are null, or of any other form,
// where it has said nothing, or is of another version.
struct WhatCulpritSays {
  Json about = nullptr;
  Json robot = nullptr;
  Json state = nullptr;
  Json control = nullptr;
  std::vector<Json> events{};  // oldest first
};

enum class Verdict : std::uint8_t {
  kWell,  // no failure is seen, all rules can see, all components are there, culprit may act, and no person is asked
  kSeesLess,  // no failure is seen, but rules that are not ERROR are blind, or a component is not there
  kNotWell  // a failure, a blind ERROR rule, no rule that can see, or culprit cannot act
};
Verdict verdict_of(const WhatCulpritSays& said);

// "rover: camera is down  [paused]"; what fails, why and what comes next; what people have ordered.
std::vector<std::string> situation_lines(const WhatCulpritSays& said, Colour colour);

// One for each component, those that are not well first.
std::vector<std::string> component_lines(const WhatCulpritSays& said, Colour colour);

// The latest events, oldest first.
std::vector<std::string> event_lines(const WhatCulpritSays& said, std::size_t most, Colour colour);

// culprit's identity, and the address of its page.
std::vector<std::string> about_lines(const WhatCulpritSays& said);

}  // namespace culprit::cli
