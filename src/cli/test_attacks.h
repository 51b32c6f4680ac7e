// For tests: attacks on a running culprit, by strangers of its domain, of its computer and of its page. Each goes on until
// what began it is destroyed. docs/security.md says what each kind of attacker cannot do.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <ostream>
#include <vector>

#include "ros2/test_eavesdropper.h"
#include "terminal/test_program.h"

namespace culprit::cli {

// The targets: culprit, and the camera that it manages.
struct Target {
  const TestWorld& world;
  int culprit = 0;                             // process
  int camera = 0;                              // process
  int page = 0;                                // port
  ros2::Eavesdropper* eavesdropper = nullptr;  // in the network where the attack comes from

  std::vector<rtps::UdpAddress> ports() const { return eavesdropper->ports_of(culprit); }
};

enum class Place : std::uint8_t {
  kHere,       // another process of this computer
  kElsewhere,  // another computer of the network
};

using Ongoing = std::shared_ptr<void>;

struct Attack {
  const char* name;  // of words, with '_' between them
  std::function<Ongoing(const Target&)> begin;
  Place from = Place::kHere;
  bool is_in_short = false;   // is one of those that `make test` tries
  const char* reported = "";  // by culprit, while it is attacked
};

// In the names of tests.
inline std::ostream& operator<<(std::ostream& out, const Attack& attack) {
  return out << attack.name;
}

std::vector<Attack> attacks_by_datagrams();     // raw, in the name of others or of nobody
std::vector<Attack> attacks_by_participants();  // with a middleware of their own
std::vector<Attack> attacks_on_this_computer();
std::vector<Attack> attacks_on_the_page();

}  // namespace culprit::cli
