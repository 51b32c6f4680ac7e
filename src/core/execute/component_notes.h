// Notes in a component's state on what a pursuit shows of it: its lifecycle and mode, who brought it up, and how
// long that took.
//
// The next strategy waits by it as long as the component needs, and leaves alone what others bring up or set
// back. Each note that the next process of culprit needs is an event, too.
#pragma once

#include "execute/pursuit.h"
#include "knowledge/knowledge.h"

namespace culprit::execute {

// Owns nothing: all references must outlive it.
class ComponentNotes {
 public:
  ComponentNotes(const Knowledge& knowledge, ComponentStates& components, Rivals& rivals,
                 EventLog& events)
      : knowledge_(knowledge), components_(components), rivals_(rivals), events_(events) {}

  // The pursuit sends this request now.
  void sends(const Pursuit& pursuit, const Pursuit::Request& request, Time now);

  // The pursuit is over, reached or not.
  void ended(const Pursuit& pursuit);

  // The pursuit has reached its goal.
  void reached_lifecycle(const Pursuit& pursuit, Time now);
  void reached_mode(const Pursuit& pursuit, Time now);
  bool is_first_rise(const Pursuit& pursuit) const;
  void came_up(const Pursuit& pursuit, Time now);

  // The pursuit was given up, since the component did not come up in time.
  void took_too_long(const Pursuit& pursuit, Time now);

 private:
  const Knowledge& knowledge_;
  ComponentStates& components_;
  Rivals& rivals_;
  EventLog& events_;
};

}  // namespace culprit::execute
