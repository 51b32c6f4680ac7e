// Requests to programs that listen at unix sockets of this machine: all at once, within one time and
// one size of answer.
//
// Any program may listen at a socket. A server that is silent, sends a byte now and then, or never
// ends its answer costs the others nothing: each request fails by itself when the common time is
// over. Before a byte is sent, the kernel shows whose process listens (SO_PEERCRED).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/time.h"

namespace culprit::http {

struct LocalRequest {
  std::filesystem::path socket;
  std::uint32_t user = 0;    // whose process has to listen there; root's may, too
  std::string text;          // the HTTP request
  std::size_t most_bytes{};  // of the answer, header included
};

struct LocalAnswer {
  int status = 0;
  std::string body;
  int process = 0;  // which listens; 0: it is of another PID namespace
};

// One answer for each request, in their order. Returns within `patience`. Errors: no server
// listens, or another user's process does; no whole answer came in time; it is larger than it may
// be, or no HTTP.
std::vector<Expected<LocalAnswer>> exchange_all(std::span<const LocalRequest> requests,
                                                Duration patience);

}  // namespace culprit::http
