// `culprit demo --robot suave`.
#pragma once

#include <string>

#include "demo/suave_demo.h"

namespace culprit::lab {

// Flies one mission, reports its events and result; `json` names a file for the outcome, or is
// empty. Gives the exit code: 0 if the pipeline was found.
int demo_suave(SuaveDemo::Options options, const std::string& json);

}  // namespace culprit::lab
