#include "cli/rule_trust.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/core.h>

namespace culprit::cli {
namespace {

namespace fs = std::filesystem;

// Whether nobody but `owner` is in the group.
bool is_private_group(gid_t group, uid_t owner) {
  const passwd* user = getpwuid(owner);
  if (user == nullptr || user->pw_gid != group) return false;
  const std::string name = user->pw_name;
  const struct group* entry = getgrgid(group);
  if (entry == nullptr || entry->gr_name != name) return false;
  for (char** member = entry->gr_mem; *member != nullptr; ++member) {
    if (*member != name) return false;
  }
  return true;
}

// What is wrong with it, and the remedy; empty if nothing is.
std::string weakness(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0)
    return fmt::format("{} cannot be looked at: {}", path.string(), std::strerror(errno));
  const bool is_ours = status.st_uid == geteuid() || status.st_uid == 0;
  if (!is_ours)
    return fmt::format("{0} belongs to user {1}; chown it to the user that runs culprit",
                       path.string(), status.st_uid);
  if (S_ISDIR(status.st_mode) && (status.st_mode & S_ISVTX) != 0) return "";
  const bool is_for_all = (status.st_mode & S_IWOTH) != 0;
  const bool is_for_group =
      (status.st_mode & S_IWGRP) != 0 && !is_private_group(status.st_gid, status.st_uid);
  if (!is_for_all && !is_for_group) return "";
  return fmt::format("{0} is writable by others; chmod go-w {0}", path.string());
}

// Likewise of what it is in.
std::string weakness_up_from(fs::path path) {
  std::string why = weakness(path);
  while (why.empty() && path != path.parent_path()) {
    path = path.parent_path();
    why = weakness(path);
  }
  return why;
}

}  // namespace

Expected<void> trust_launches(const RuleSet& rules, const std::string& path) {
  const bool launches = std::any_of(rules.components.begin(), rules.components.end(),
                                    [](const Component& c) { return !c.launch.empty(); });
  if (!launches) return {};
  std::error_code error;
  const fs::path file = fs::canonical(path, error);
  if (error) return Error{fmt::format("cannot find {}: {}", path, error.message())};
  // A link could be replaced as well as what it leads to.
  for (const fs::path& start : {file, fs::absolute(path)}) {
    if (const std::string why = weakness_up_from(start); !why.empty())
      return Error{fmt::format(
          "{} says which programs are started, and somebody else could change it: {}", path, why)};
  }
  return {};
}

}  // namespace culprit::cli
