// How much came over a connection. In a file of its own: the kernel's header defines it, and cannot
// be included beside any other header of sockets.
#pragma once

#include <cstdint>

namespace culprit::alerts {

// Bytes since it was made; 0 if the socket is no TCP socket.
std::uint64_t received_bytes(int socket);

}  // namespace culprit::alerts
