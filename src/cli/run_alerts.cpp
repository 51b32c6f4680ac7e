#include "cli/run_alerts.h"

#include "base/environment.h"
#include "terminal/console.h"
#include "web/hub_observer.h"

namespace culprit::cli {

Expected<std::unique_ptr<RunAlerts>> RunAlerts::open(const std::string& file) {
  if (file.empty()) return std::unique_ptr<RunAlerts>();
  auto settings = alerts::read_settings(file);
  if (!settings) return Error{settings.error()};
  return std::make_unique<RunAlerts>(std::move(*settings));
}

RunAlerts::RunAlerts(alerts::Settings settings)
    : page_(settings.page),
      courier_(std::move(settings.to),
               [](const std::string& trouble) { say(stderr, "culprit: {}\n", trouble); }),
      alerting_(
          {settings.wait, host_name(), [this] { return page_; }},
          [this](const alerts::Alert& alert) { courier_.post(alert); },
          web::HubObserver::wall_clock) {}

void RunAlerts::set_page(const std::string& address) {
  if (page_.empty()) page_ = address.substr(0, address.find("/#"));
}

}  // namespace culprit::cli
