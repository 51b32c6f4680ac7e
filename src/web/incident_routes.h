// The calls about what went wrong so far: the times that the robot was not well, what happened in one of them, and a page
// about it to send.
#pragma once

#include <filesystem>

#include "http/hub.h"
#include "http/routes.h"

namespace culprit::web {

// `recordings`: the folder of the black box (recorder/recording_folder.h); empty: there is none. Incidents are read from `journal`. Without a journal, or if it
// cannot be read, they come from the events that the stream still has. `hub` must outlive the routes.
std::vector<Route> incident_routes(Hub& hub, std::filesystem::path journal,
                                   std::filesystem::path recordings = {});

}  // namespace culprit::web
