#include "alerts/templates.h"

#include <cmath>
#include <ctime>
#include <string_view>

#include <fmt/core.h>

#include "json/json.h"

namespace culprit::alerts {
namespace {

// RFC 3339, in UTC.
std::string timestamp_of(double seconds_since_1970) {
  const double whole = std::floor(seconds_since_1970);
  const auto at = static_cast<std::time_t>(whole);
  std::tm day{};
  gmtime_r(&at, &day);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &day);
  return fmt::format("{}.{:03.0f}Z", text,
                     std::min(999.0, std::floor(1000 * (seconds_since_1970 - whole))));
}

bool is_firing(const Alert& alert) { return alert.state == Alert::State::kFiring; }

// Names come from the robot. Slack requires these three to be escaped, and reads no other markup in
// verbatim text (api.slack.com/reference/surfaces/formatting).
std::string for_slack(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

// A webhook's message (api.slack.com/messaging/webhooks).
Json slack(const Alert& alert) {
  const char* sign = !is_firing(alert)    ? ":white_check_mark: "
                     : alert.needs_person ? ":sos: "
                                          : ":warning: ";
  std::string text = sign + for_slack(text_of(alert));
  if (!alert.link.empty()) text += "\n<" + for_slack(alert.link) + "|See it on culprit's page>";
  return {{"text", text}, {"unfurl_links", false}};
}

// The body of POST /api/v2/alerts (prometheus.io/docs/alerting/latest/alerts_api). Labels
// distinguish alerts: they stay the same until it is over. So a fault that a person is needed for
// is a second alert beside the first.
Json alertmanager(const Alert& alert) {
  Json all = Json::array();
  for (const char* name : {"CulpritFault", "CulpritNeedsPerson"}) {
    if (name == std::string_view("CulpritNeedsPerson") && !alert.needs_person) continue;
    Json entry{
        {"labels",
         {{"alertname", name}, {"robot", alert.robot}, {"host", alert.host}, {"fault", alert.id}}},
        {"annotations", {{"summary", alert.headline}, {"description", text_of(alert)}}},
        {"startsAt", timestamp_of(alert.began)}};
    if (!alert.link.empty()) entry["generatorURL"] = alert.link;
    if (!is_firing(alert)) entry["endsAt"] = timestamp_of(alert.ended);
    all.push_back(std::move(entry));
  }
  return all;
}

Json plain(const Alert& alert) {
  Json json{{"format", "culprit-alert"},
            {"format_version", 1},
            {"state", is_firing(alert) ? "firing" : "resolved"},
            {"id", alert.id},
            {"text", text_of(alert)},
            {"robot", alert.robot},
            {"host", alert.host},
            {"headline", alert.headline},
            {"health", alert.health},
            {"needs_person", alert.needs_person},
            {"rule", alert.rule},
            {"components", alert.components},
            {"consequences", alert.consequences},
            {"doing", alert.doing},
            {"next", alert.next},
            {"began", timestamp_of(alert.began)}};
  if (!is_firing(alert)) json["ended"] = timestamp_of(alert.ended);
  if (!alert.link.empty()) json["link"] = alert.link;
  if (alert.untold > 0) json["untold"] = alert.untold;
  return json;
}

}  // namespace

std::string body_for(Destination::Kind kind, const Alert& alert) {
  switch (kind) {
    case Destination::Kind::kSlack:
      return to_line(slack(alert));
    case Destination::Kind::kAlertmanager:
      return to_line(alertmanager(alert));
    case Destination::Kind::kJson:
    case Destination::Kind::kCommand:
      break;
  }
  return as_json(alert);
}

std::string path_for(Destination::Kind kind, const Url& url) {
  constexpr const char* kApi = "/api/v2/alerts";
  if (kind != Destination::Kind::kAlertmanager || url.path.ends_with(kApi)) return url.path;
  return url.path.substr(0, url.path.find_last_not_of('/') + 1) + kApi;
}

std::string as_json(const Alert& alert) { return to_line(plain(alert)); }

}  // namespace culprit::alerts
