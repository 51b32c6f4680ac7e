// Notifies systemd about a service of Type=notify (sd_notify(3)), by datagrams to the socket that
// $NOTIFY_SOCKET names. Without this variable, it does nothing.
//
// The watchdog is fed from the decision loop, not from a thread of its own: what hangs is to be
// found hanging.
#pragma once

#include <optional>
#include <string>

#include "base/time.h"

namespace culprit::live {

class ServiceManager {
 public:
  // Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  void ready(const std::string& status) const;
  void stopping() const;

  // The decision loop is alive. Feeds the watchdog only when it is due.
  void feed(Time now);
  // The loop has to come round by then: half of the watchdog's time. kNever without a watchdog.
  Time next_feeding() const { return next_; }

 private:
  void tell(const std::string& state) const;

  int socket_ = -1;
  std::string address_;
  std::optional<Duration> period_;
  Time next_ = kNever;
};

}  // namespace culprit::live
