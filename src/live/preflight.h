// Compares a robot with the names in the rules. `check --robot` reports the result, `run` and `plan
// --robot` report it before anything else.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "base/time.h"
#include "language/source.h"
#include "link/survey.h"

namespace culprit::live {

// "no nodes were seen on domain 7; is ROS_DOMAIN_ID the robot's? Processes of this machine are on
// domain 0 (lidar_driver (process 4711))."
std::string no_nodes_on(std::uint32_t domain);

// Looks until all that these rules name is there, or `wait` is over, or it is to stop; asks
// systemd about their units, and looks for what their launch commands need. Runs nothing of theirs.
LiveInventory look_for(const std::vector<const RuleSet*>& rules, link::Survey& survey,
                       Duration wait, const std::stop_token& stop = {});

struct Snapshot {
  bool has_robot = false;
  std::string report;  // whole lines
};

// Looks at the robot of the environment, for 3 s at most. Errors: the domain cannot be joined, or
// is secured.
Expected<Snapshot> take_snapshot(const Source& source,
                                 const std::vector<std::filesystem::path>& message_path);

// Looks at the robot of the environment on a thread of its own, and says what it found: once all is
// there, or 3 s are over. Without a robot it says so, and looks until there is one.
class Preflight {
 public:
  // The rules must be without errors. `say` is called on the thread, with whole lines.
  Preflight(Source rules, std::vector<std::filesystem::path> message_path,
            std::function<void(const std::string&)> say);

 private:
  void look(const std::stop_token& stop) const;

  const Source source_;
  const std::vector<std::filesystem::path> message_path_;
  const std::function<void(const std::string&)> say_;
  std::jthread thread_;  // ends looking with the object
};

}  // namespace culprit::live
