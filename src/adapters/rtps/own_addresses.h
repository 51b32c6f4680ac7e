// The addresses by which this machine can be reached, as far as sockets go: another container, with a network of its own, is
// another machine.
#pragma once

#include <array>
#include <cstdint>
#include <set>

namespace culprit::rtps {

// IPv4, of all interfaces that have one. Only 127.0.0.1 if the system lists none.
std::set<std::array<std::uint8_t, 4>> own_addresses();

}  // namespace culprit::rtps
