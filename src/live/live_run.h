// One running culprit: one session after the other, as often as the rules are reloaded or its role
// is another one, until it is stopped.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "base/mutex.h"
#include "live/live_session.h"
#include "live/role.h"
#include "live/service_manager.h"

namespace culprit::live {

class LiveRun {
 public:
  struct Options {
    LiveSession::Options session;
    bool dry_run = false;
    bool improvises = false;  // the rules are completed (live/rule_file.h), those reloaded too
    Fleet* fleet = nullptr;   // null: there is none; else it outlives the run
  };

  // All that it refers to must outlive it. `observer` may be null.
  LiveRun(Options options, RoleOfCulprit role, OrderKeeper& keeper, Listener& listener,
          Observer* observer);

  // Joins the robot's DDS domain. Errors: that is impossible.
  Expected<void> join(LoadedRules rules);
  // Begins to manage; `desk` takes orders from now on. @pre join() succeeded
  void begin(OrderTaker& desk, const std::atomic<bool>& stopped);
  // Manages until it is stopped; the code that sets `stopped` must call leave(), too. If culprit
  // stays deaf, it replaces itself in this process, and run() does not return. Errors: the robot
  // cannot be joined in another role. @pre begin() was called
  Expected<void> run(OrderTaker& desk, const std::atomic<bool>& stopped);
  // Its latest one.
  Role role() const { return role_.role(); }

  // The following may be called from any thread.

  // Something is to be looked at now.
  void interrupt();
  void leave();
  // Reads the rule file anew, for the next session. Gives how many rules there are. Errors: the
  // file is wrong, or of another robot.
  Expected<std::size_t> reload(const std::string& author);

 private:
  struct Next {
    LoadedRules rules;
    std::string author;
  };

  void take_role();
  void enter(LiveSession* session);
  void open(OrderTaker& desk);
  void close(OrderTaker& desk);
  Expected<void> change_role(OrderTaker& desk, const std::atomic<bool>& stopped);
  bool take_over(const std::atomic<bool>& stopped);
  void change_rules(Next next, OrderTaker& desk);
  void look_at_neighbours();
  void watch_hearing(OrderTaker& desk);
  std::optional<Next> take_next();

  const Options options_;
  RoleOfCulprit role_;
  LiveSession::Frame frame_;
  std::unique_ptr<LiveSession> session_;
  ServiceManager systemd_;

  Mutex mutex_;
  LiveSession* entered_ CULPRIT_GUARDED_BY(mutex_) =
      nullptr;  // the session that is on; null: none is now
  std::optional<Next> next_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace culprit::live
