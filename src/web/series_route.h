// The call for one curve: what a plot of the page shows before it follows the stream.
#pragma once

#include "http/routes.h"
#include "web/signal_history.h"
#include "web/usage_history.h"

namespace culprit::web {

// Both observe the robot once they are started, whether a page is open or not.
struct Histories {
  UsageHistory usage;
  SignalHistory signals;

  // As soon as a page is served.
  void start() {
    usage.start();
    signals.start();
  }
};

// `histories` must outlive the route.
Route series_route(const Histories& histories);

}  // namespace culprit::web
