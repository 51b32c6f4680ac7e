// How much came over a connection. In a file of its own: the kernel's header knows it, and no other header of
// sockets may stand beside that.
#pragma once

#include <cstdint>

namespace culprit::alerts {

// Bytes since it was made; 0 of what is no TCP socket.
std::uint64_t received_bytes(int socket);

}  // namespace culprit::alerts
