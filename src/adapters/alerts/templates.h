// An alert as those take it that it is sent to.
#pragma once

#include <string>

#include "alerts/alert.h"
#include "alerts/settings.h"

namespace culprit::alerts {

// The body of a request, as JSON. @pre it is no command's
std::string body_for(Destination::Kind kind, const Alert& alert);

// Where it is posted: of an Alertmanager its API, else the address as it stands.
std::string path_for(Destination::Kind kind, const Url& url);

// {"format": "culprit-alert", "format_version": 1, "state": "firing", ...} (docs/alerts.md)
std::string as_json(const Alert& alert);

}  // namespace culprit::alerts
