// The variable that processes which culprit started for a component have in their environment (owners/mark.h).
#pragma once

namespace culprit {

inline constexpr const char* kComponentVariable = "CULPRIT_COMPONENT";  // "0/sunset/camera"

}  // namespace culprit
