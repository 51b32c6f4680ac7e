// Who leaves, and whether that is a launch which somebody ends.
//
// What one process has started (a launch file, a shell) ends with it: on Ctrl-C all get the same
// signal, and end one after the other, each in its own time. Whoever started one of them anew
// meanwhile would fight the person who pressed it. So, of what has one launcher:
//
//   one left by somebody's wish     the others may be about to: nobody knows for kAlone
//   several did                     they leave together, until none has for kTogether
//   and their launcher ended        that was the wish. What left is not there to be brought back
//                                   until somebody starts it again
//   somebody started it again       it has kBack to speak
//
// A launch may also end because something in it broke (on_exit=Shutdown() in a launch file), or
// because culprit ended something in it. That is nobody's wish: once its launcher has ended, too,
// what left may be brought back.
#pragma once

#include <optional>
#include <vector>

#include "base/time.h"
#include "language/rule_set.h"

namespace culprit {

class Departures {
 public:
  static constexpr Duration kAlone = std::chrono::seconds(2);
  // ros2 launch asks a second time after 5 s, and kills after another 5 s.
  static constexpr Duration kTogether = std::chrono::seconds(11);
  static constexpr Duration kBack = std::chrono::seconds(10);

  explicit Departures(const RuleSet& rules);

  // A process of the component began. Who started it is not known, or it is culprit.
  void arrived(ComponentId component, Time at);
  // It was started by process `launcher`, which is no supervisor, and not culprit.
  void launched(ComponentId component, int launcher);
  void launcher_ended(int launcher, Time at);
  // It left: of its own or of somebody's will, as it seems. Again, for what left already: nothing.
  void left(ComponentId component, Time at);
  // It did not want to: it broke, or culprit ended it.
  void fell(ComponentId component, Time at);
  // It is gone, and nobody knows why.
  void lost(ComponentId component) { members_[component.index].has_left = true; }

  enum class What : std::uint8_t {
    kIsEnding,  // the launch that the component belongs to
    kHasEnded,  // likewise, because somebody wished it
    kIsBack     // it was started again a moment ago
  };
  struct Departure {
    What what = What::kIsEnding;
    int launcher = 0;
    Time until = kNever;
  };
  // Nothing: it may be adapted.
  std::optional<Departure> of(ComponentId component, Time now) const;

 private:
  struct Launch {
    int launcher = 0;
    int left = 0;             // how many, since one fell last or none had left for kTogether
    Time left_at = kLongAgo;  // the last one of them
    Time fell_at = kLongAgo;  // one that did not want to
    bool is_wish = false;     // the first of those that left was followed, and none fell before
    Time ended = kNever;      // the launcher
  };
  struct Member {
    int launcher = 0;  // 0: none is known
    bool has_left = false;
    Time back = kLongAgo;  // after its launch had been ended
  };

  Launch* launch_of(ComponentId component);
  const Launch* launch_of(ComponentId component) const;
  bool was_ended(const Launch& launch, const Member& member) const;

  std::vector<Member> members_;  // by component
  std::vector<Launch> launches_;
};

}  // namespace culprit
