// The model of a lifecycle manager (lifecycle_manager.h), failures included: a state machine that is stepped instead of a thread.
//
// Times are those of lifecycle_manager.cpp: bonds break after 4 s, are looked at each 200 ms, and a reset waits 10 s for the servers.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "base/time.h"
#include "robot/command.h"

namespace culprit::rover::model {

class BondManager {
 public:
  // How a request to a server would end.
  enum class Reach : std::uint8_t {
    kAnswers,
    kBlocks,  // it hangs, or the middleware has not noticed its death
    kNobody   // no server of that name
  };
  // The servers as the manager sees them, by their places in the order of start-up.
  struct Servers {
    std::size_t count = 0;
    std::function<Reach(std::size_t)> reach;
    std::function<int(std::size_t)> pid;
    // Gives whether the server agrees.
    std::function<bool(std::size_t, Transition)> change;
    std::function<Duration()> answer_time;
  };

  BondManager(Servers servers, bool has_bonds);

  // All servers are active and bonded.
  void begin_active(Time now);
  // A new process: it waits for all servers, and starts them up.
  void begin(Time now);
  // Called each tick while its process runs.
  void step(Time now);
  void on_bond(std::size_t server, Time now) { heard_[server] = now; }
  // ~/manage_nodes with command 0 (startup); `done` is never called while the manager is blocked.
  void ask_startup(std::function<void(bool)> done) { requests_.push_back(std::move(done)); }
  // It waits for an answer that never comes, or gave up.
  bool is_stuck() const { return blocked_on_.has_value() || phase_ == Phase::kIdle; }

 private:
  enum class Phase : std::uint8_t { kWaiting, kStarting, kActive, kResetting, kRespawning, kIdle };
  struct Change {
    std::size_t server;
    Transition transition;
  };

  void start_up();
  void reset();
  void advance(Time now);
  void finish(bool is_done, Time now);
  bool are_all_there() const;
  bool is_blocked();

  const Servers servers_;
  const bool has_bonds_;
  Phase phase_ = Phase::kIdle;
  std::deque<Change> changes_{};
  Time due_ = kLongAgo;              // of the answer to the first change; or of the next look
  Time until_ = kLongAgo;            // kRespawning
  std::optional<int> blocked_on_{};  // a process
  std::vector<Time> heard_;
  std::deque<std::function<void(bool)>> requests_{};
  std::function<void(bool)> answer_{};  // of the request that is being worked on
};

}  // namespace culprit::rover::model
