// Delivers alerts to all destinations, on a thread for each, so that one that hangs delays no
// other, and none delays the caller.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "alerts/outbox.h"
#include "alerts/settings.h"

namespace culprit::alerts {

class Courier {
 public:
  // `tell` receives, from any thread, which alerts could not be sent and when they can be again;
  // nothing of it is secret. A name server that hangs may delay it beyond the end of the courier.
  Courier(std::vector<Destination> destinations, std::function<void(const std::string&)> tell);
  // Sends the alerts that can be sent in a moment before it ends, and logs how many are lost.
  ~Courier();

  // Does not wait for anybody. From any thread.
  void post(const Alert& alert);

 private:
  class Route;
  std::vector<std::shared_ptr<Route>> routes_;
};

}  // namespace culprit::alerts
