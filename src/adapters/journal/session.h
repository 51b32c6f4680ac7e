// One run of culprit: all inputs that the manager was made with, so that a replay can make it
// again.
#pragma once

#include <optional>
#include <string>

#include "base/time.h"
#include "journal/json.h"
#include "journal/learned.h"
#include "language/rule_set.h"

namespace culprit::journal {

struct Session {
  std::string version;  // of culprit
  std::string robot;
  std::string rules_path;
  std::string rules_text;
  std::string occasion;            // "reloaded by ada"; empty: culprit was started
  Json planner;                    // as its options have it
  Json governor = Json::object();  // likewise
  bool advises = false;
  bool continued = false;  // the run began in another file, which is gone: it cannot be replayed
  int domain = 0;          // of DDS: another domain is another robot
  int process = 0;         // culprit's, on its machine; 0: an older culprit left it out
  std::string boot;        // which start of the machine: the robot's clock counts from there
  Time start{};
  std::int64_t wall =
      0;  // nanoseconds since 1970 at `start`; 0: an older culprit, which told no incidents
  // The manager began with what this process had seen while another culprit managed, and so as if it
  // had watched since then; nothing: since `start`.
  std::optional<Time> watched_since;
  Duration discovery{};
  double forgetting = 1;
  Learned learned;                   // what was known at the start
  Json interrupted = Json::array();  // what the run before left behind (requests.h)
  Json past = Json::array();         // what earlier runs did that still counts (history.h)
  Json known_robot;                  // what they saw of this robot (known_robot.h)
  // By a person's order in the run before, which goes on: repeated with the first step.
  bool is_paused = false;
  bool is_dry_run = false;
  // People's standing orders are in a file of their own (standing_orders.h); older culprits have it
  // in the rows only.
  bool orders_kept = false;
  // The context in which what is learned is shared with a fleet; nothing: it is not. Beliefs begin
  // from the fleet's priors then, which the steps contain; those of `learned` hold until that.
  std::optional<std::string> fleet_context;
};

// Also the form of what `culprit beliefs export` writes.
Json to_json(const Learned& learned);
Expected<Learned> learned_from_json(const Json& json);

Json to_json(const Session& session);
Expected<Session> session_from_json(const Json& json);

// The kernel's name for the time since the machine was started; empty where it has none.
std::string boot_id();

}  // namespace culprit::journal
