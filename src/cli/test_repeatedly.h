// For tests: something that goes on until it is destroyed.
#pragma once

#include <chrono>
#include <functional>
#include <stop_token>
#include <thread>
#include <utility>

namespace culprit::cli {

class Repeatedly {
 public:
  // Calls `act` on a thread of its own, and waits for `pause` each time.
  Repeatedly(std::chrono::milliseconds pause, std::function<void()> act)
      : thread_([pause, act = std::move(act)](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            act();
            std::this_thread::sleep_for(pause);
          }
        }) {}

 private:
  std::jthread thread_;
};

}  // namespace culprit::cli
