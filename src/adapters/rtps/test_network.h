// For tests with a bad network: two computers and the cable between them.
//
// Each computer is a network namespace with a loopback and one Ethernet device; the cable is a
// thread that carries the frames from one TAP device to the other. It can be set to lose, delay,
// double and reorder them. (Linux's own netem is not in every kernel.) Needs the right to make
// network namespaces, and /dev/net/tun.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "base/expected.h"
#include "base/mutex.h"
#include "base/time.h"

namespace culprit {

struct NetworkTrouble {
  double lost = 0;     // share of the frames
  double doubled = 0;  // share of the frames
  Duration delay{};    // of each frame: evenly between this and twice as much, so they overtake
  bool is_cut = false;
};

class TestNetwork {
 public:
  enum Computer { kRobot, kDesk };

  // Error: this process may not, or this machine cannot.
  static Expected<std::unique_ptr<TestNetwork>> create();
  ~TestNetwork();
  TestNetwork(const TestNetwork&) = delete;
  TestNetwork& operator=(const TestNetwork&) = delete;

  // While it lives, the thread that made it opens its sockets on that computer, and so do the
  // threads and processes that it starts.
  class Visit {
   public:
    Visit(const TestNetwork& network, Computer computer);
    ~Visit();
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;

   private:
    int home_;
  };

  void set(const NetworkTrouble& trouble);
  // Frames that came through since the beginning, both ways.
  std::size_t carried() const { return carried_; }

 private:
  struct End {
    int space = -1;  // the network namespace
    int tap = -1;
  };
  struct Frame {
    Time due;
    int to;  // a TAP device
    std::vector<char> bytes;
  };

  TestNetwork() = default;
  Expected<void> open(Computer computer);
  void carry();
  void accept(const End& from, const End& to);
  Duration deliver_due();

  std::array<End, 2> ends_;
  std::vector<Frame> under_way_;
  std::mt19937 random_{1};
  Mutex mutex_;
  NetworkTrouble trouble_ CULPRIT_GUARDED_BY(mutex_);
  std::atomic<std::size_t> carried_ = 0;
  std::atomic<bool> is_over_ = false;
  std::thread cable_;
};

}  // namespace culprit
