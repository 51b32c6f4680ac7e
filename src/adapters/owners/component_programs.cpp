#include "owners/component_programs.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <utility>

#include "owners/launch_file.h"
#include "owners/mark.h"
#include "owners/start_needs.h"

namespace culprit::owners {

std::filesystem::path ComponentPrograms::file_of(ComponentId component) const {
  std::string file = robot.empty() ? rules[component].name : mark(component);
  std::ranges::replace(file, '/', '-');
  return log_folder / file;
}

std::filesystem::path ComponentPrograms::log(ComponentId component) const {
  return file_of(component).native() + ".log";
}

Expected<std::vector<std::string>> ComponentPrograms::environment(ComponentId component) const {
  if (component.index < environments.size()) return environments[component.index];
  return std::vector<std::string>();
}

Program ComponentPrograms::program(ComponentId component, int launcher) const {
  const Component& what = rules[component];
  Program program{what.launch, search_first, log(component), {}, {}};
  program.lifetime = lifetime;
  program.folder = what.folder;
  if (const auto variables = environment(component)) program.environment = *variables;
  const std::string prefixes = value_in_environment("AMENT_PREFIX_PATH", program.environment);
  program.needs = start_needs(what.launch, prefixes);
  program.arguments = program_of_launch(what.launch, prefixes);
  if (!robot.empty()) {
    for (std::string& each : mark_of(mark(component)))
      program.environment.push_back(std::move(each));
    if (std::string place = in_place_of(launcher); !place.empty())
      program.environment.push_back(std::move(place));
    program.pid_variable = kPidVariable;
  }
  return program;
}

// The file is its user's alone from the beginning: any user that can open a file can lock it.
Expected<FileDescriptor> ComponentPrograms::lock_start(ComponentId component) const {
  const std::string& name = rules[component].name;
  std::error_code error;
  std::filesystem::create_directories(log_folder, error);
  const std::filesystem::path path = file_of(component).native() + ".start";
  FileDescriptor lock(
      open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW, 0600));
  if (!lock)
    return Error{"cannot start " + name + ": its lock file, " + path.string() +
                 ", cannot be made: " + std::strerror(errno)};
  if (flock(lock.get(), LOCK_EX | LOCK_NB) == 0) return Expected<FileDescriptor>(std::move(lock));
  return Error{errno == EWOULDBLOCK
                   ? name + " is being started already; look at what its program waits for"
                   : "cannot start " + name + ": " + path.string() +
                         " cannot be locked: " + std::strerror(errno)};
}

}  // namespace culprit::owners
