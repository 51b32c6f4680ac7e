// Reports to a person the datagrams that culprit does not use: those that the filter refused, those that speak for a
// node and do not come from its process, and those that our own full sockets dropped.
//
// Counts are reported at their first unit and then tenfold (tenfold.h), sources once each.
//
// On the executor's thread.
#pragma once

#include "base/time.h"
#include "inbox/inbox.h"
#include "link/tenfold.h"
#include "ros2/context.h"

namespace culprit::link {

class DatagramTroubles {
 public:
  // `context` and `inbox` must outlive it. `has_helper`: the sockets are those of the helper program.
  DatagramTroubles(ros2::Context& context, Inbox& inbox, bool has_helper)
      : context_(context), inbox_(inbox), has_helper_(has_helper) {}

  // Reports what is new (LinkTrouble).
  void tell(Time now);

 private:
  void tell_of_refused();
  void tell_of_foreign_sources(Time now);
  void tell_of_dropped();

  ros2::Context& context_;
  Inbox& inbox_;
  const bool has_helper_;
  Tenfold refused_{1};    // datagrams; a robot sends none of them
  Tenfold dropped_{100};  // by our own full sockets; a burst of announcements may cost a few
};

}  // namespace culprit::link
