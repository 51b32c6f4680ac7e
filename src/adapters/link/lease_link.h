// The lease's way to the wire: announces the claim of this culprit in the domain, sends its beats,
// and receives those of others (manager_lease.h).
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "link/manager_lease.h"
#include "ros2/context.h"
#include "ros2/hearing.h"
#include "ros2/timer.h"

namespace culprit::link {

class LeaseLink {
 public:
  struct Options {
    LeaseClaim claim;
    bool manages = false;  // now
    // People's orders, for the successor. Called on a thread of the link; must not wait.
    std::function<std::string()> told_orders{};
  };

  // All outlive it, and their executor does not run yet; it must not run when this one goes.
  // Errors: the middleware, or the domain's permissions, refuse.
  static Expected<std::unique_ptr<LeaseLink>> open(ros2::Context& context,
                                                   const ros2::Hearing& hearing,
                                                   ros2::Executor& executor, Options options);

  // On the executor's thread.
  void on_discovery(const ros2::DiscoveryEvent& event);

  // From any thread, all of these.

  // Until when it is sure that no other culprit manages the robot. Not later than `now`: it is not.
  Time sure_until(Time now) const;
  // Where the culprit runs, on another machine, that goes before this one for the robot, or for the
  // node of this full name: a host's name, or "another machine" if it announces none. Nothing:
  // there is none.
  std::optional<std::string> elder() const;
  std::optional<std::string> elder_at(const std::string& node) const;
  // Where those run that claim the same and do not prove it.
  std::vector<std::string> strangers() const;
  // The orders that the last manager of this robot, on another machine or here, announced; empty:
  // it announced none. Nothing: there was no manager.
  std::optional<std::string> told_orders() const;
  // The other state that the last manager announced for its successor, and by how much our clock is
  // ahead of its. Nothing: it announced none, or some parts were lost.
  std::optional<ManagerLease::ToldState> told_state() const;
  std::int64_t highest_term() const;
  // The state of this manager, from now on.
  void tell_state(std::string state);
  // Informs the successor now and not with the next beat: the last message of a culprit that steps
  // back or ends.
  void say();
  // This one, which did not manage, does from now on, in this term, and announces it beside what it
  // had announced. By one thread. Errors: the middleware refuses; then nothing has changed.
  Expected<void> take_over(std::int64_t term);

 private:
  LeaseLink(ros2::Context& context, const ros2::Hearing& hearing, Options options);
  Expected<std::vector<std::unique_ptr<ros2::Writer>>> announce(
      const std::vector<std::string>& announcements);
  Expected<void> listen();

  bool is_here(const rtps::GuidPrefix& participant) const CULPRIT_REQUIRES(mutex_);
  std::string host_of(const rtps::GuidPrefix& participant) const CULPRIT_REQUIRES(mutex_);

  void on_beat(const ros2::Sample& sample);  // on a receive thread

  const Options options_;
  ros2::Context& context_;
  const ros2::Hearing& hearing_;
  std::vector<std::unique_ptr<ros2::Writer>> writers_;      // the first sends the beats
  std::vector<std::unique_ptr<ros2::Writer>> of_new_term_;  // after take_over()

  mutable Mutex mutex_;  // the middleware is not called under it
  struct Neighbour {
    std::string host;
    bool is_here = false;  // on this machine
  };
  ManagerLease lease_ CULPRIT_GUARDED_BY(mutex_);
  bool manages_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::map<rtps::GuidPrefix, Neighbour> neighbours_
      CULPRIT_GUARDED_BY(mutex_);  // of those that can be discovered

  std::unique_ptr<ros2::Reader> reader_;
  std::unique_ptr<ros2::Timer> timer_;
};

}  // namespace culprit::link
