// A draft that lasts: what it names is still there after the next launch, and after a reboot.
//
// `ros2 launch` writes the parameters of each node into a file below a temporary folder and names that on the
// command line (--params-file /tmp/launch_params_...). A redeploy with that file would bring back old values
// after the launch file was edited, and fail after a reboot. So the draft names a copy beside the rules.
#pragma once

#include <string>
#include <vector>

#include "init/robot_profile.h"

namespace culprit::init {

struct KeptFile {
  std::string path;  // beside the rules: "/home/ann/my.camera.params.yaml"
  std::string text;
  bool operator==(const KeptFile&) const = default;
};

struct Kept {
  std::vector<KeptFile> files;     // to be written with the draft
  std::vector<std::string> notes;  // for people: what could not be kept
};

// Whether the file may be gone tomorrow: it is below /tmp, /var/tmp, /dev/shm, /run or $TMPDIR.
bool is_temporary(const std::string& path);

// Each start in `seen` that reads a temporary file of parameters reads its copy instead. `rules`: the whole
// path of the rule file; empty: the draft is not written to a file, so nothing can be kept beside it.
Kept keep_parameters(RobotProfile& seen, const std::string& rules);

}  // namespace culprit::init
