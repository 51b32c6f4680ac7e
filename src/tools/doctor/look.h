// Looks at a robot for some seconds, and changes nothing: it joins as a hidden node, and its one
// reader is best effort.
#pragma once

#include "base/expected.h"
#include "base/time.h"
#include "doctor/picture.h"
#include "ros2/participant.h"

namespace culprit::doctor {

// Errors: the domain cannot be joined.
Expected<Picture> look(const ros2::ParticipantOptions& options, Duration time);

}  // namespace culprit::doctor
