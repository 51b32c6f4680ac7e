// Long calculations for web clients: done by a process of its own, so that their time, memory and errors do not affect the manager.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/expected.h"

namespace culprit::web {

// A folder for what such a process reads and writes. It goes with all that is in it.
class AsideFolder {
 public:
  AsideFolder();
  ~AsideFolder();
  AsideFolder(const AsideFolder&) = delete;

  std::string file(const char* name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

struct Printed {
  int status = 0;  // that it exited with
  std::string text;
};

// Runs a program of `arguments` with the lowest priority to its end, for so many seconds of the processor at most. It ends
// with the thread that calls this. Errors: it cannot be run, was killed, or took longer.
Expected<Printed> run_aside(std::vector<std::string> arguments, const AsideFolder& folder,
                            int most_seconds);

}  // namespace culprit::web
