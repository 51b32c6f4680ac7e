// The message about one fault, for a person: sent once when the fault is there, and once when it is
// over.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace culprit::alerts {

struct Alert {
  enum class State : std::uint8_t { kFiring, kResolved };
  std::string id;  // of the fault: the same from its beginning to its end, and never again
  State state = State::kFiring;
  bool needs_person = false;  // culprit cannot help itself any more, or waits for approval
  std::string robot;          // may be empty
  std::string host;           // that culprit runs on
  std::string headline;       // "camera is down"
  std::string health;         // "ERROR", as the page has it
  std::string rule;           // the failure that explains the others; empty: it is about no rule
  std::vector<std::string> components{};    // that are held responsible
  std::vector<std::string> consequences{};  // rules that fail because of it
  std::string doing;                        // what is done about it, or what became of it
  std::string next;                         // what comes next; may be empty
  double began = 0;                         // seconds since 1970
  double ended = 0;                         // likewise, if it is resolved
  std::string link;                         // of the page; may be empty
  std::uint64_t untold = 0;                 // alerts before this one that were given up
};

// One line: "rover: camera is down (ERROR), so that FusionSilent fails; being repaired: redeploy camera".
std::string text_of(const Alert& alert);

}  // namespace culprit::alerts
