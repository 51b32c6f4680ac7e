// The call that plays one run of a study's campaign again (study/single_run.h), for the timeline.
#pragma once

#include "web/routes.h"

namespace culprit::cli {

// Plays one at a time, as a guest: on a thread of the lowest priority.
web::Route single_run_route();

}  // namespace culprit::cli
