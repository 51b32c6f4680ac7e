#include "alerts/received_bytes.h"

#include <linux/in.h>
#include <linux/tcp.h>
#include <sys/socket.h>

namespace culprit::alerts {

std::uint64_t received_bytes(int socket) {
  tcp_info info{};
  socklen_t length = sizeof info;
  return getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &length) == 0 ? info.tcpi_bytes_received
                                                                        : 0;
}

}  // namespace culprit::alerts
