#include "owners/setup.h"

#include <algorithm>
#include <string_view>
#include <sys/wait.h>
#include <unistd.h>

#include "owners/piped_program.h"
#include "owners/spawn.h"

namespace culprit::owners {
namespace {

// The file sees no arguments. Its output is for people, so it goes to standard error.
constexpr const char* kLine =
    R"(culprit_setup=$1; shift; . "$culprit_setup" >&2 && exec /usr/bin/env -0)";

bool begins_with_any(std::string_view variable, std::initializer_list<std::string_view> names) {
  return std::any_of(names.begin(), names.end(),
                     [&](std::string_view name) { return variable.starts_with(name); });
}

// ": No such file or directory", from its last output.
std::string last_words(const std::string& errors) {
  const std::string line = last_line(errors);
  return line.empty() ? "" : ": " + line;
}

}  // namespace

Expected<std::vector<std::string>> environment_after(const std::filesystem::path& file,
                                                     const std::vector<std::string>& given,
                                                     Duration limit) {
  const std::string name = "SETUP " + file.string();
  // BASH_ENV names another file that bash would read.
  std::vector<std::string> before = environment_with(given);
  std::erase_if(before, [](const std::string& v) { return v.starts_with("BASH_ENV="); });
  const auto run =
      run_piped({"/bin/bash", "--noprofile", "--norc", "-c", kLine, "culprit-setup", file.native()},
                before, limit);
  if (!run) return Error{name + ": " + run.error()};
  if (run->end == PipedRun::End::kTime)
    return Error{name + " took longer than " + culprit::to_string(limit) + last_words(run->err)};
  if (run->end == PipedRun::End::kTooMuch) return Error{name + " gives too large an environment"};
  const std::string& printed = run->out;
  std::vector<std::string> after;
  for (std::size_t begin = 0; begin < printed.size();) {
    const std::size_t end = printed.find('\0', begin);
    if (end == std::string::npos) break;
    std::string variable = printed.substr(begin, end - begin);
    // Those are the shell's own.
    if (!begins_with_any(variable, {"_=", "SHLVL=", "PWD=", "OLDPWD="}))
      after.push_back(std::move(variable));
    begin = end + 1;
  }
  if (after.empty()) return Error{name + " failed" + last_words(run->err)};
  std::erase_if(after, [&](const std::string& variable) {
    return std::any_of(given.begin(), given.end(), [&](const std::string& each) {
      return variable.starts_with(each.substr(0, each.find('=') + 1));
    });
  });
  after.insert(after.end(), given.begin(), given.end());
  return after;
}

}  // namespace culprit::owners
