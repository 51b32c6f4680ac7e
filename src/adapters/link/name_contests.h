// Nodes of one name: culprit acts on none of them, and a person is told which processes they are, who
// started them, and how to end the extra one.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "base/time.h"
#include "ros2/graph.h"

namespace culprit::link {

// All members may be called from any thread.
class NameContests {
 public:
  // One that ends, or is ended, needs no person.
  static constexpr Duration kSettles = std::chrono::seconds(2);
  // Only a person can end that, and late joiners must learn of it too.
  static constexpr Duration kReminder = std::chrono::minutes(1);

  // `is_ours`: the node of a component, or a container that one is in.
  void seen(const ros2::NodeNamesakes& seen, bool is_ours, Time now);

  // For each node of ours whose name others have too: the text for a person.
  std::map<std::string, std::string> texts() const;
  // The texts whose report, or reminder, is due.
  std::vector<std::string> due(Time now);
  // The processes of all nodes of one name, where there are several: by that name; 0: on another
  // machine, or not proven.
  std::map<std::string, std::vector<int>> processes() const;

 private:
  struct Contest {
    std::string text;
    Time due{};  // for the report
  };

  mutable Mutex mutex_;
  std::map<std::string, Contest> contests_ CULPRIT_GUARDED_BY(mutex_);            // by node
  std::map<std::string, std::vector<int>> processes_ CULPRIT_GUARDED_BY(mutex_);  // likewise
};

}  // namespace culprit::link
