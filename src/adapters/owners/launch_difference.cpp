#include "owners/launch_difference.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <sys/stat.h>

#include "base/live_clock.h"
#include "owners/launch_file.h"
#include "owners/parameter_file.h"
#include "owners/proc.h"

namespace culprit::owners {
namespace {

namespace fs = std::filesystem;

struct Parts {
  std::string program;                 // "driver": of a whole path the last part
  std::vector<std::string> arguments;  // without files of parameters
  std::vector<std::string> files;      // of parameters, as they are written
};

std::string last_part(const std::string& path) { return fs::path(path).filename().native(); }

Parts parts_of(const std::vector<std::string>& command) {
  std::size_t at = 0;
  const bool is_python = last_part(command[0]).starts_with("python3") && command.size() > 1 &&
                         !command[1].starts_with('-');
  if (is_python) at = 1;
  if (last_part(command[at]) == "ros2" && at + 3 < command.size() && command[at + 1] == "run")
    at += 3;
  Parts parts{last_part(command[at]), {}, {}};
  for (++at; at < command.size(); ++at) {
    if (command[at] == "--params-file" && at + 1 < command.size())
      parts.files.push_back(command[++at]);
    else
      parts.arguments.push_back(command[at]);
  }
  // Without arguments behind it, as `ros2 launch` adds it, it changes nothing.
  if (!parts.arguments.empty() && parts.arguments.back() == "--ros-args")
    parts.arguments.pop_back();
  return parts;
}

// The part between a common beginning and a common end.
std::string differing(const std::vector<std::string>& all, std::size_t begin, std::size_t end) {
  std::string text;
  for (std::size_t i = begin; i < all.size() - end; ++i) text += (text.empty() ? "" : " ") + all[i];
  return text;
}

std::string arguments_in_words(const std::vector<std::string>& runs,
                               const std::vector<std::string>& written) {
  const std::size_t most = std::min(runs.size(), written.size());
  std::size_t begin = 0;
  while (begin < most && runs[begin] == written[begin]) ++begin;
  std::size_t end = 0;
  while (end < most - begin && runs[runs.size() - 1 - end] == written[written.size() - 1 - end])
    ++end;
  // "--fps 30", not "30".
  if (begin > 0 && runs[begin - 1].starts_with('-')) --begin;
  const std::string now = differing(runs, begin, end);
  const std::string later = differing(written, begin, end);
  if (now.empty()) return "runs without '" + later + "', which its LAUNCH has";
  if (later.empty()) return "runs with '" + now + "', which its LAUNCH has not";
  return "runs with '" + now + "', and its LAUNCH has '" + later + "'";
}

std::string in_folder(const std::string& file, const std::string& folder) {
  return folder.empty() ? file : (fs::path(folder) / file).native();
}

using Values = std::map<std::string, std::string>;

// The values of all readable files; later files override earlier ones.
Values values_in(const std::vector<std::string>& files, const std::string& folder,
                 const std::string& node) {
  Values values;
  for (const std::string& file : files) {
    const auto read = read_parameter_file(in_folder(file, folder), node);
    if (!read) continue;
    for (const auto& [name, value] : *read) values[name] = to_yaml(value);
  }
  return values;
}

bool is_there(const std::string& file) {
  std::error_code error;
  return fs::exists(file, error);
}

std::optional<std::int64_t> changed_at(const std::string& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) return std::nullopt;
  return std::int64_t{status.st_mtime};
}

std::string or_none(const Values& values, const std::string& name) {
  const auto found = values.find(name);
  return found == values.end() ? "none" : found->second;
}

// The first one that differs: of many that do, all have one reason.
std::string parameters_in_words(const Values& runs, const Values& written) {
  Values all = runs;
  all.insert(written.begin(), written.end());
  for (const auto& [name, value] : all) {
    const std::string now = or_none(runs, name);
    const std::string later = or_none(written, name);
    if (now != later)
      return "was started with " + name + ": " + now + ", and its LAUNCH gives it " + later;
  }
  return "";
}

}  // namespace

std::optional<RunningProcess> running_process(int pid) {
  const fs::path process = "/proc/" + std::to_string(pid);
  std::error_code error;
  RunningProcess found;
  found.program = fs::read_symlink(process / "exe", error).native();
  if (error) return std::nullopt;
  constexpr std::string_view kDeleted = " (deleted)";
  found.program_is_gone = found.program.ends_with(kDeleted);
  if (found.program_is_gone) found.program.resize(found.program.size() - kDeleted.size());
  auto started = started_as(pid);
  const auto since = started_at(pid);
  if (!started || !since) return std::nullopt;
  found.started = std::move(*started);
  found.started_at = (wall_now() - (live_now() - *since).count()) / 1'000'000'000;
  return found;
}

std::vector<std::string> launch_differences(const std::vector<std::string>& launch,
                                            const std::string& folder, const std::string& node,
                                            const RunningProcess& process) {
  std::vector<std::string> all;
  if (launch.empty() || process.started.command.empty()) return all;
  // An adjustment of the clock, and the rounding of both times, are no change.
  constexpr std::int64_t kSlack = 2;
  const auto is_newer = [&](const std::string& file) {
    const auto changed = changed_at(file);
    return changed && *changed > process.started_at + kSlack;
  };
  const auto look_at_program = [&] {
    if (process.program_is_gone)
      all.push_back(
          is_there(process.program)
              ? "runs a program that was replaced since it was started: a redeploy starts "
                "the new " +
                    process.program
              : "runs a program that is not there any more: " + process.program);
  };
  // Its arguments are known only when it is evaluated, at the start.
  if (const auto source = launch_file_node(launch)) {
    look_at_program();
    if (is_newer(source->file))
      all.push_back("was started before its launch file '" + source->file + "' was changed");
    return all;
  }
  const Parts runs = parts_of(process.started.command);
  const Parts written = parts_of(launch);
  if (runs.program != written.program) {
    all.push_back("runs " + runs.program + ", and its LAUNCH starts " + written.program);
  } else if (runs.arguments != written.arguments) {
    all.push_back(arguments_in_words(runs.arguments, written.arguments));
  }
  look_at_program();
  for (const std::string& file : written.files) {
    const std::string path = in_folder(file, folder);
    if (!is_there(path))
      all.push_back("cannot be started again: there is no parameter file '" + path + "'");
    else if (is_newer(path) && std::ranges::find(runs.files, file) != runs.files.end())
      all.push_back("was started before its parameter file '" + path + "' was changed");
  }
  if (runs.files != written.files) {
    const std::string parameters =
        parameters_in_words(values_in(runs.files, process.started.folder, node),
                            values_in(written.files, folder, node));
    const bool can_compare = std::ranges::all_of(runs.files, [&](const std::string& file) {
      return is_there(in_folder(file, process.started.folder));
    });
    if (can_compare && !parameters.empty()) all.push_back(parameters);
  }
  return all;
}

}  // namespace culprit::owners
