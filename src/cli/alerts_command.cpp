#include <atomic>
#include <csignal>
#include <memory>

#include <fmt/core.h>

#include "alerts/sender.h"
#include "base/environment.h"
#include "cli/commands.h"
#include "terminal/console.h"
#include "web/hub_observer.h"

namespace culprit::cli {
namespace {

struct AlertsOptions {
  std::string file;
  bool json = false;
};

alerts::Alert test_alert(const std::string& page) {
  alerts::Alert alert;
  alert.began = alert.ended = web::HubObserver::wall_clock();
  alert.id = fmt::format("test-{:.0f}", alert.began);
  alert.state = alerts::Alert::State::kResolved;
  alert.needs_person = true;  // all destinations want it
  alert.host = host_name();
  alert.headline = "this is a test of culprit's alerts";
  alert.health = "OK";
  alert.link = page;
  return alert;
}

int try_alerts(const AlertsOptions& options) {
  ::signal(SIGPIPE, SIG_IGN);  // who is sent something may hang up
  const auto settings = alerts::read_settings(options.file);
  if (!settings) return fail(settings.error());
  constexpr Duration kPatience = std::chrono::seconds(10);
  const std::atomic<bool> stop = false;
  const alerts::Alert alert = test_alert(settings->page);
  bool are_all_sent = true;
  Json list = Json::array();
  for (const alerts::Destination& destination : settings->to) {
    const alerts::Sent sent = alerts::send(destination, alert, kPatience, stop);
    const bool is_sent = sent.how == alerts::Sent::How::kSent;
    are_all_sent &= is_sent;
    list.push_back({{"destination", destination.name()}, {"sent", is_sent}, {"why", sent.why}});
    if (!options.json)
      say(stdout, "{}: {}\n", destination.name(), is_sent ? "sent" : "NOT sent: " + sent.why);
  }
  if (options.json) say(stdout, "{}\n", to_line(list));
  return are_all_sent ? kOk : kFailed;
}

}  // namespace

void add_alerts(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<AlertsOptions>();
  CLI::App* command = app.add_subcommand(
      "alerts", "Send a test alert to each receiver (run --alerts sends the real ones)");
  command->add_option("FILE", options->file, "File with the receivers of alerts (docs/alerts.md)")
      ->type_name("FILE")
      ->required();
  command->add_flag("--json", options->json, "Print the result of each as a JSON document");
  command->callback([options, &exit_code] { exit_code = try_alerts(*options); });
}

}  // namespace culprit::cli
