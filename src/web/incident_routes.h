// The calls about what went wrong so far: the times that the robot was not well, what happened in one of them, and a page
// about it to send.
#pragma once

#include <filesystem>

#include "http/hub.h"
#include "http/routes.h"

namespace culprit::web {

// `recordings`: the folder of the black box (recorder/recording_folder.h); empty: there is none. They are told from `journal`; from what the stream still has where that is empty (no journal is written) or cannot be
// read. `hub` must outlive the routes.
std::vector<Route> incident_routes(Hub& hub, std::filesystem::path journal,
                                   std::filesystem::path recordings = {});

}  // namespace culprit::web
