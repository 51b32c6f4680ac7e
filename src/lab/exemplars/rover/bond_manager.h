// A lifecycle manager that behaves as Nav2's (nav2_lifecycle_manager of Humble), failures included, as a state machine that is
// stepped: by lifecycle_manager.cpp live, by rover_model.cpp in virtual time.
//
// - It configures all servers in their order, then activates them. If one refuses, the start has failed, and it does nothing more.
// - Each active server keeps a bond on /bond. If a bond is broken for 4 s while all are active, the manager deactivates the servers
//   backwards and cleans them up backwards. A server that refuses is passed over. One that is missing ends the reset, and
//   nothing is cleaned up.
// - No request has a timeout: a server that is hung, or whose death the middleware has not noticed, blocks it for ever.
// - After a reset it starts all up again if all answer within 10 s.
// - ~/manage_nodes (startup, pause, resume, reset) is answered once it is done: never, while the manager is blocked.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "base/time.h"
#include "robot/command.h"

namespace culprit::rover {

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
    // Gives whether the server agrees. Live it blocks until the server answers, instead of kBlocks.
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
  // The last heartbeat of an active server.
  void on_bond(std::size_t server, Time at) { heard_[server] = std::max(heard_[server], at); }
  // ~/manage_nodes: 0 startup, 1 pause, 2 resume, 3 reset. `done` is never called while the manager is blocked.
  void ask(std::uint8_t command, std::function<void(bool)> done) {
    requests_.emplace_back(command, std::move(done));
  }
  // It waits for an answer that never comes, or gave up.
  bool is_stuck() const { return blocked_on_.has_value() || phase_ == Phase::kIdle; }
  bool is_changing() const { return !changes_.empty(); }
  bool is_resetting() const { return phase_ == Phase::kResetting; }

 private:
  enum class Phase : std::uint8_t {
    kWaiting,
    kStarting,
    kActive,
    kResetting,  // because of a bond
    kRespawning,
    kStopping,  // by request
    kIdle
  };
  struct Change {
    std::size_t server;
    Transition transition;
  };

  // The servers in their order while it starts, else backwards.
  void change_all(Phase phase, std::initializer_list<Transition> transitions);
  void start_up() { change_all(Phase::kStarting, {Transition::kConfigure, Transition::kActivate}); }
  void serve_request();
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
  std::deque<std::pair<std::uint8_t, std::function<void(bool)>>> requests_{};
  std::function<void(bool)> answer_{};  // of the request that is being worked on
};

}  // namespace culprit::rover
