#include "cli/run_alerts.h"

#include "base/environment.h"
#include "terminal/console.h"
#include "web/hub_observer.h"

namespace culprit::cli {

Expected<std::optional<alerts::Settings>> RunAlerts::read(const std::string& file) {
  if (file.empty()) return std::optional<alerts::Settings>();
  auto settings = alerts::read_settings(file);
  if (!settings) return Error{"--alerts: " + settings.error()};
  return std::optional(std::move(*settings));
}

std::unique_ptr<RunAlerts> RunAlerts::open(std::optional<alerts::Settings> settings) {
  return settings ? std::make_unique<RunAlerts>(std::move(*settings)) : nullptr;
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
