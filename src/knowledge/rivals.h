// Who else steers the robot: parameters and modes that something else sets back.
//
// A value was set back if a strategy is to change it again and finds it as it was before the last
// time, though nobody of ours undid that, and neither the component nor anything that it depends on
// began anew since. After two times in a row it is left alone, until the component begins anew: two
// managers that set a value by turns would never end.
//
// A parameter that resets itself when its routine is done is no rival's work. It does so before the
// failure is over, so of parameters only what was in place then counts; modes do not reset
// themselves.
#pragma once

#include <map>
#include <string>

#include "language/ids.h"
#include "language/value.h"
#include "robot/time.h"

namespace culprit {

// What of a component is set. `parameter` is empty where it is the mode.
struct Subject {
  ComponentId component;
  std::string parameter;
  auto operator<=>(const Subject&) const = default;
};

class Rivals {
 public:
  static constexpr int kTimes = 2;

  // We brought it from `before` to `value`, and read that back. It, or something that it depends
  // on, last began anew at `began`; here and below.
  void changed(const Subject& subject, Value before, Value value, Time began, Time now);
  // It is no longer as we set it, and no rival is to blame.
  void forget(const Subject& subject) { changes_.erase(subject); }

  // Whether to change `present` to `value` once more would be to fight.
  bool would_fight(const Subject& subject, const Value& present, const Value& value,
                   Time began) const {
    return times_set_back(subject, present, value, began) >= kTimes;
  }
  void leave_alone(const Subject& subject, Time now) { left_alone_[subject] = now; }
  bool is_left_alone(const Subject& subject, Time began) const;
  bool is_anything_left_alone() const { return !left_alone_.empty(); }

  // What we set it to last; null if we did not, or it was forgotten.
  const Value* ours(const Subject& subject) const;

 private:
  struct Change {
    Value before;
    Value value;
    Time at;
    int set_back = 0;  // the changes before it in a row, times
  };

  int times_set_back(const Subject& subject, const Value& present, const Value& value,
                     Time began) const;

  std::map<Subject, Change> changes_;  // the last of each
  std::map<Subject, Time> left_alone_;
};

}  // namespace culprit
