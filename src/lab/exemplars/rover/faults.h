// The rover's faults, with the ground truth: what is injected where, who is responsible, and what mends it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "base/value.h"

namespace culprit::rover {

enum class Way : std::uint8_t {
  kKill,        // SIGKILL
  kStop,        // SIGSTOP
  kNextStart,   // SIGKILL, and the next process starts with `parameter` (rover_node_main.cpp)
  kParameter,   // a parameter of the node
  kDeactivate,  // somebody deactivates the node
  kStray        // somebody starts one more process of that name
};

struct Fault {
  std::string name;  // "kill:amcl", "lidar:stall"
  Way way = Way::kKill;
  std::string process{};    // where it is injected (nodes.h)
  std::string parameter{};  // kParameter, kNextStart
  Value value{};            // of the parameter; a double for kNextStart
  std::string cause{};      // the component of rover.rules that is responsible; empty: none
  std::string remedies{};   // for people; empty: nothing but a person mends it
  bool is_fixable() const { return !remedies.empty(); }
};

const std::vector<Fault>& faults();

// Faults that come at once.
struct Play {
  std::string name{};                  // "kill:amcl+kidnapped"
  std::vector<const Fault*> faults{};  // none: a rover that is well
  std::uint64_t seed = 1;              // of the model

  std::vector<std::string> fault_names() const;
  bool is_fixable() const;
  bool is_cause(std::string_view component) const;
};
Play play_of(std::vector<const Fault*> faults, std::uint64_t seed = 1);
// An error names the faults that there are.
Expected<Play> find_play(std::string_view name, std::uint64_t seed = 1);

// Measurements of the rover, live or in virtual time.
struct Measurements {
  int goals_reached = 0;
  int goals_failed = 0;
  int collisions = 0;  // live only; so driven_m
  double driven_m = 0;
  double stood_s = 0;       // in all; live: since restart_measuring()
  double standing_s = 0;    // until now
  double pose_error_m = 0;  // of amcl
  // The fault that can be seen: a server is not active, the rover does not know where it is, or it stands. Empty: none.
  std::string complaint{};

  static constexpr double kLostAt = 0.8;  // metres
  // `inactive`: a server that is not active; empty: there is none.
  void complain(const std::string& inactive);
};

}  // namespace culprit::rover
