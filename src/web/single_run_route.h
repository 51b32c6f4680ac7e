// The call that plays one run of a study's campaign again, for the timeline: culprit-lab plays it.
#pragma once

#include "http/routes.h"

namespace culprit::web {

// Plays one at a time, as a guest: in a process of the lowest priority.
Route single_run_route();

}  // namespace culprit::web
