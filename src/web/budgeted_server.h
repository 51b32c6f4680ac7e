// httplib's server, with a budget for each connection.
//
// httplib itself keeps every header that comes, however many and however long a line is, and waits
// anew for each byte. Here what a connection sends is counted before it is parsed: so many bytes of
// headers, so many of a body, and so much time for both. Whoever exceeds them is cut off.
#pragma once

#include <chrono>
#include <cstddef>
#include <httplib.h>

namespace culprit::web {

struct ConnectionBudget {
  std::size_t header_bytes = 8u << 10;  // request line included
  std::size_t body_bytes = 1u << 20;
  std::chrono::milliseconds request = std::chrono::seconds(10);  // from its first byte to its last
  std::chrono::milliseconds idle = std::chrono::seconds(2);      // between two requests
  std::chrono::milliseconds write = std::chrono::seconds(5);     // for each piece of an answer
  int requests = 1000;
};

class BudgetedServer : public httplib::Server {
 public:
  explicit BudgetedServer(ConnectionBudget budget) : budget_(budget) {}

 private:
  bool process_and_close_socket(socket_t socket) override;

  const ConnectionBudget budget_;
};

// How many connections may be open at a time: not more than `wanted`, and so few that enough
// descriptors are left for everything else that this process opens. At least one.
std::size_t affordable_connections(std::size_t wanted);

}  // namespace culprit::web
