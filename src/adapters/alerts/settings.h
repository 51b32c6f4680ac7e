// Where alerts go, as a file says that only its user can read: addresses of webhooks are secrets.
//
//     page: http://rover.lan:8642    # where whoever gets an alert can open the page
//     wait: 5s                       # what is over by then is one message, not two
//     to:
//       - slack: https://hooks.slack.com/services/...
//       - alertmanager: http://127.0.0.1:9093
//       - json: https://example.org/robots
//         ca: /etc/ssl/ours.pem      # who signs its certificate, if not one of the system's
//       - command: [/usr/local/bin/page-operator, --robot, rover]
//         when: person               # only what a person is needed for
#pragma once

#include <string>
#include <vector>

#include "base/expected.h"
#include "base/units.h"

namespace culprit::alerts {

struct Destination {
  enum class Kind : std::uint8_t { kSlack, kAlertmanager, kJson, kCommand };
  Kind kind = Kind::kJson;
  std::string url;                     // a secret; empty: a command
  std::vector<std::string> command{};  // the program and its arguments, never for a shell
  std::string ca{};                    // a file of certificates; empty: those of the system
  bool only_for_person = false;

  // For people, and without what is secret: "slack at hooks.slack.com", "command page-operator".
  std::string name() const;
};

struct Settings {
  std::string page;  // empty: that of this culprit, if it has one
  Duration wait = std::chrono::seconds(5);
  std::vector<Destination> to;
};

// Errors: others can read the file, it cannot be read, or is wrong; with the line.
Expected<Settings> read_settings(const std::string& path);

// "http" or "https", a host, a port and a path: "https://example.org:8443/hook".
struct Url {
  std::string origin;  // "https://example.org:8443"
  std::string host;    // "example.org"
  std::string path;    // "/hook", with the query
};
Expected<Url> read_url(const std::string& text);

}  // namespace culprit::alerts
