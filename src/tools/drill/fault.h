// A fault that a drill injects into a component, and how it is written.
//
//     to_string(Fault{FaultKind::kKill, "camera"})                  // "kill camera"
//     to_string(Fault{FaultKind::kSetParameter, "camera", "exposure", Value(0.0)})
//                                                                   // "set_parameter camera exposure 0.0"
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/value.h"
#include "json/json.h"

namespace culprit::drill {

enum class FaultKind : std::uint8_t {
  kKill,          // SIGKILL
  kHang,          // SIGSTOP for a time, then SIGCONT
  kSlow,          // SIGSTOP and SIGCONT in a rhythm
  kDeactivate,    // a lifecycle node
  kRestart,       // deactivate, then activate
  kSetParameter,  // to `value`
  kLoss           // most datagrams from and to the ports of its process
};
inline constexpr FaultKind kFaultKinds[] = {
    FaultKind::kKill,    FaultKind::kHang,         FaultKind::kSlow, FaultKind::kDeactivate,
    FaultKind::kRestart, FaultKind::kSetParameter, FaultKind::kLoss};
// "kill", "hang", ... as DRILL lines and --kinds take them. These words stand in files.
std::string_view word_of(FaultKind kind);
std::optional<FaultKind> fault_kind(std::string_view word);
// The message about a word that names none: the kinds, and the one that was probably meant.
std::string no_fault_kind(std::string_view word);

struct Fault {
  FaultKind kind = FaultKind::kKill;
  std::string component;
  std::string parameter{};  // kSetParameter
  Value value{};            // likewise
  bool operator==(const Fault&) const = default;
};

// Whether it acts on the process, not on the node.
bool acts_on_process(FaultKind kind);
// Whether it goes on for a time that is chosen beforehand.
bool lasts(FaultKind kind);

std::string to_string(const Fault& fault);
// "kill camera + hang depth"
std::string to_string(const std::vector<Fault>& faults);

Json to_json(const Fault& fault);
// Nothing: it is none.
std::optional<Fault> fault_from(const Json& json);

Json value_to_json(const Value& value);
std::optional<Value> value_from(const Json& json);

}  // namespace culprit::drill
