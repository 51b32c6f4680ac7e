// What a picture of a robot shows to be wrong. Pure, and the same for the same picture.
//
//     const auto picture = doctor::look(options, 8s);      // look.h
//     for (const doctor::Finding& finding : doctor::examine(*picture)) print(finding);
#pragma once

#include <vector>

#include "doctor/finding.h"
#include "doctor/picture.h"

namespace culprit::doctor {

// The worst first, then by code and name.
std::vector<Finding> examine(const Picture& picture);

// Who does not hear whom, and why: D001 to D004.
std::vector<Finding> examine_connections(const Picture& picture);

}  // namespace culprit::doctor
