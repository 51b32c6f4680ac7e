// The call by which people want a recording of the robot now (docs/recording.md).
#pragma once

#include <filesystem>
#include <functional>

#include "http/routes.h"

namespace culprit::web {

// Begins a recording, called `why`; gives where it is. Errors: why not.
using RecordNow = std::function<Expected<std::filesystem::path>(const std::string& why)>;

// `record` is empty where nothing is recorded.
std::vector<Route> recording_routes(RecordNow record);

}  // namespace culprit::web
