// The connections of a server, and which of them wait for their client: for a request that is only begun, or for an
// answer to be taken.
//
// Each connection keeps a thread, and threads are few. A client that sends half a header costs nothing and could keep
// all of them. So when the last thread is taken, the connection whose client has been waited for longest ends, and a
// new one takes its place: a request that arrives whole is always served.
//
// All members may be called from any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>

#include "base/mutex.h"

namespace culprit::http {

class WaitingClients {
 public:
  using Clock = std::chrono::steady_clock;
  // Clients take long answers in pieces: one that takes a piece sooner is not ended for others.
  static constexpr std::chrono::seconds kAnswerPatience{1};

  enum class For : std::uint8_t { kNothing, kRequest, kAnswer };

  // A connection, for as long as it lives. One thread uses it.
  class Connection {
   public:
    // Waits for a request. @pre the socket stays open while this exists
    Connection(WaitingClients& all, int socket);
    ~Connection();
    Connection(const Connection&) = delete;

    // `since` matters if it waits for something.
    void waits(For what, Clock::time_point since = {});
    // Until the next request, it is never ended for another.
    void spare();
    void begin_request();

   private:
    WaitingClients& all_;
    const int socket_;
  };

  // Shuts down the connection whose client has been waited for longest: for a request if there is any, else for an
  // answer. False: none waits.
  bool end_one(Clock::time_point now = Clock::now());

 private:
  struct Wait {
    For what = For::kRequest;
    Clock::time_point since;
    bool is_spared = false;
    bool is_ended = false;
  };

  Mutex mutex_;
  std::map<int, Wait> waits_ CULPRIT_GUARDED_BY(mutex_);  // by socket
};

}  // namespace culprit::http
