// The rover's faults, with the ground truth: what is injected where, who is responsible, and what mends it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/value.h"

namespace culprit::rover {

enum class Way : std::uint8_t {
  kKill,       // SIGKILL
  kStop,       // SIGSTOP
  kParameter,  // a parameter of the node
  kDeactivate  // somebody deactivates the node
};

struct Fault {
  std::string name;  // "kill:amcl", "lidar:stall"
  Way way = Way::kKill;
  std::string process{};    // where it is injected (nodes.h)
  std::string parameter{};  // kParameter
  Value value{};            // kParameter
  std::string cause{};      // the component of rover.rules that is responsible
  std::string remedies{};   // for people; empty: nothing but a person mends it
  bool is_fixable() const { return !remedies.empty(); }
};

const std::vector<Fault>& faults();
// Null: there is none of that name.
const Fault* find_fault(std::string_view name);

}  // namespace culprit::rover
