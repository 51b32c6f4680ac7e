// The autopilot's parameters for its thrusters, as ArduSub has them: 0 silences one, 32 and its
// number drives it.
#pragma once

#include <cstdint>
#include <string>

namespace culprit::suave {

inline std::string servo_of(int thruster) {
  return "SERVO" + std::to_string(thruster) + "_FUNCTION";
}
inline std::int64_t working_servo(int thruster) { return 32 + thruster; }

}  // namespace culprit::suave
