// httplib's server, with a budget for each connection.
//
// httplib itself keeps every header that comes, however many and however long a line is, and waits
// again for each byte. Here the bytes of a connection are counted before they are parsed: so many
// bytes of headers, so many of a body, so much time for the headers, and so much for both. A connection that exceeds them is
// closed. A request that is only begun keeps one of the few threads from others, so its headers have little time. It ends at
// once if another connection needs the thread (waiting_clients.h).
//
// Nor does it compress answers: httplib would use brotli at its slowest if the browser accepts
// that, and the incidents of a day came after seconds. takes_gzip() says whether the client can
// unpack an answer that is packed already.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <httplib.h>
#include <memory>
#include <utility>

#include "http/tls.h"
#include "http/waiting_clients.h"

namespace culprit::http {

struct ConnectionBudget {
  std::size_t header_bytes = 8u << 10;  // request line included
  std::size_t body_bytes = 1u << 20;
  std::chrono::milliseconds header =
      std::chrono::seconds(3);  // from its first byte to the headers' end
  std::chrono::milliseconds request = std::chrono::seconds(10);  // from its first byte to its last
  std::chrono::milliseconds idle = std::chrono::seconds(2);      // between two requests
  std::chrono::milliseconds write = std::chrono::seconds(5);     // for each piece of an answer
  int requests = 1000;
};

// The clients that are served. For a unix socket the kernel gives the user at its other end.
enum class Clients : std::uint8_t { kAny, kOwnUser };

// While one lives, BudgetedServers close each connection that they are to serve on this thread, without an answer.
class RefusesConnections {
 public:
  RefusesConnections();
  ~RefusesConnections();
  RefusesConnections(const RefusesConnections&) = delete;
};

// The request that a BudgetedServer serves on this thread is never ended for another: its client has shown a token.
void spare_this_request();

// Whether the client of a BudgetedServer's request accepts gzip.
bool takes_gzip(const httplib::Request& request);

class BudgetedServer : public httplib::Server {
 public:
  // `tls`: null: what is sent is not encrypted. @pre kOwnUser: it is bound to a unix socket
  BudgetedServer(ConnectionBudget budget, Clients clients, std::shared_ptr<const TlsContext> tls)
      : budget_(budget), clients_(clients), tls_(std::move(tls)) {}

  // So many connections may wait to be taken, instead of httplib's five. @pre it is bound
  void let_wait(int connections);
  // Ends the connection whose client has been waited for longest. False: none waits for its client.
  bool end_one() { return waiting_.end_one(); }

 private:
  bool process_and_close_socket(socket_t socket) override;
  bool serve(socket_t socket);

  const ConnectionBudget budget_;
  const Clients clients_;  // kOwnUser: and root
  const std::shared_ptr<const TlsContext> tls_;
  WaitingClients waiting_;
};

// How many connections may be open at a time: not more than `wanted`, and so few that enough
// descriptors are left for everything else that this process opens. At least one.
std::size_t affordable_connections(std::size_t wanted);

}  // namespace culprit::http
