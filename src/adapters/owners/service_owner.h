// A program that runs services by itself, and that culprit asks to start and to end them: systemd
// its units, a container engine its containers.
#pragma once

#include <string>
#include <vector>

#include "base/expected.h"
#include "base/time.h"

namespace culprit::owners {

// The state of a service, as its owner reports it.
struct UnitState {
  enum class Activity : std::uint8_t {
    kActive,
    kActivating,  // it is being started, also by the owner itself
    kDeactivating,
    kInactive,
    kFailed
  };
  bool is_loaded = false;  // there is such a one, and it can be started
  Activity activity = Activity::kInactive;
  bool has_job = false;    // it is asked for something that is not done yet
  int main_pid = 0;        // 0: none
  int last_main_pid = 0;   // of this boot; 0: none
  std::string load_state;  // "loaded", "not-found", "masked", ...
  std::string result;      // how it ended: "success", "exit-code", "start-limit-hit", ...

  // It ended as on an order, or on one that it answered with an error; not by itself with an error or SIGKILL.
  bool is_orderly = false;

  bool is_over() const { return activity == Activity::kInactive || activity == Activity::kFailed; }
};

// Every call has a time limit, and blocks its thread for so long at most. Errors give the fault and
// the remedy; nothing was done then.
class ServiceOwner {
 public:
  virtual ~ServiceOwner() = default;

  virtual Expected<UnitState> state_of(const std::string& service) = 0;
  virtual Expected<void> start(const std::string& service) = 0;
  // `polite`: how long its processes have to end by themselves, if the request can contain that (an
  // engine kills them then; systemd waits as its unit configures).
  virtual Expected<void> stop(const std::string& service, Duration polite) = 0;
  virtual Expected<void> restart(const std::string& service, Duration polite) = 0;
  // SIGKILL to all its processes.
  virtual Expected<void> kill(const std::string& service) = 0;

  // Whether the process is of that service.
  virtual Expected<bool> runs(const std::string& service, int pid) = 0;
  // All that it has, or could load.
  virtual Expected<std::vector<std::string>> services() = 0;
  // Whether culprit has the right to start and to end it. Errors: it has not.
  virtual Expected<void> may_manage(const std::string& service) = 0;

  // Whether the owner answered the last call, whatever the answer was.
  virtual bool was_reached() const = 0;

  // For people: "systemd", "docker".
  virtual std::string name() const = 0;
  // The command that shows why a service failed: "journalctl -u lidar.service".
  virtual std::string where_to_look(const std::string& service) const = 0;
  // The command that lists its services.
  virtual std::string what_lists_all() const = 0;
};

}  // namespace culprit::owners
