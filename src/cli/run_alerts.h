// Sends alerts to people while culprit runs, if they want them: events are examined on the thread that manages, and sent by others.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "alerts/courier.h"
#include "alerts/settings.h"
#include "live/alerting.h"

namespace culprit::cli {

class RunAlerts {
 public:
  // Without a `file`, there are no settings. Errors: the file is wrong.
  static Expected<std::optional<alerts::Settings>> read(const std::string& file);
  // Begins a thread, if there are receivers; else null.
  static std::unique_ptr<RunAlerts> open(std::optional<alerts::Settings> settings);
  explicit RunAlerts(alerts::Settings settings);

  live::Observer& observer() { return alerting_; }
  // Where the page is, where the file does not say: "http://127.0.0.1:8642/#token=..."; the token is not passed on.
  // On the thread that manages.
  void set_page(const std::string& address);

 private:
  std::string page_;
  alerts::Courier courier_;
  live::Alerting alerting_;
};

}  // namespace culprit::cli
