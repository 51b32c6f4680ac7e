// Rivals of culprit: other programs that set a mode back.
//
// A mode was set back if a strategy is to change it again and finds its value from before the last
// change. It was not set back if culprit undid the change, or if the component, or anything that it
// depends on, began anew since. After two times in a row culprit leaves it alone, until the
// component begins anew: two managers that set a mode by turns would never end.
//
// Parameters are not watched so: routines reset their own, and people bring back what they had once
// the failure is over.
#pragma once

#include <map>
#include <string>

#include "base/ids.h"
#include "base/time.h"

namespace culprit {

class Rivals {
 public:
  static constexpr int kTimes = 2;

  // We brought the mode of `system` from `before` to `mode`, and read that back. It, or something
  // that it depends on, last began anew at `began`; here and below.
  void changed(ComponentId system, std::string before, std::string mode, Time began, Time now);
  // It is no longer as we set it, and no rival is to blame.
  void forget(ComponentId system) { changes_.erase(system); }

  // Whether to change `present` to `mode` once more would be to fight.
  bool would_fight(ComponentId system, const std::string& present, const std::string& mode,
                   Time began) const {
    return times_set_back(system, present, mode, began) >= kTimes;
  }
  void leave_alone(ComponentId system, Time now) { left_alone_[system] = now; }
  bool is_left_alone(ComponentId system, Time began) const;
  bool is_anything_left_alone() const { return !left_alone_.empty(); }

 private:
  struct Change {
    std::string before;
    std::string mode;
    Time at;
    int set_back = 0;  // the changes before it in a row, times
  };

  int times_set_back(ComponentId system, const std::string& present, const std::string& mode,
                     Time began) const;

  std::map<ComponentId, Change> changes_;  // the last of each
  std::map<ComponentId, Time> left_alone_;
};

}  // namespace culprit
