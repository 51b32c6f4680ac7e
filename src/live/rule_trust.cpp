#include "live/rule_trust.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

#include <fmt/core.h>

namespace culprit::live {
namespace {

namespace fs = std::filesystem;

// Whether `owner` is the only member of the group.
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

// The weakness and its remedy; empty if there is none.
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

// The same for the folders that contain it.
std::string weakness_up_from(fs::path path) {
  std::string why = weakness(path);
  while (why.empty() && path != path.parent_path()) {
    path = path.parent_path();
    why = weakness(path);
  }
  return why;
}

// A link could be replaced as well as what it leads to.
std::string weakness_of_all(const fs::path& path) {
  std::error_code error;
  const fs::path file = fs::canonical(path, error);
  if (error) return fmt::format("cannot find {}: {}", path.string(), error.message());
  std::string why = weakness_up_from(file);
  return why.empty() ? weakness_up_from(fs::absolute(path)) : why;
}

// The journal and what is kept beside it, whose names begin with its name: the lock, the last writes.
std::vector<fs::path> files_of(const fs::path& journal) {
  std::vector<fs::path> files;
  const fs::path folder = journal.has_parent_path() ? journal.parent_path() : ".";
  std::error_code error;
  for (fs::directory_iterator i(folder, error); !error && i != fs::directory_iterator();
       i.increment(error)) {
    if (i->path().filename().native().starts_with(journal.filename().native()))
      files.push_back(i->path());
  }
  return files;
}

}  // namespace

Expected<void> trust_rules(const std::string& path) {
  const std::string why = weakness_of_all(path);
  if (why.starts_with("cannot find")) return Error{why};
  if (!why.empty())
    return Error{fmt::format(
        "{} decides what is done to the robot, and another user could change it: {}", path, why)};
  return {};
}

Expected<void> trust_setup(const std::string& path) {
  const std::string why = weakness_of_all(path);
  if (why.starts_with("cannot find")) return Error{fmt::format("SETUP: {}", why)};
  if (!why.empty())
    return Error{fmt::format(
        "SETUP {} is run before a LAUNCH, and another user could change it: {}", path, why)};
  return {};
}

Expected<void> trust_state(const fs::path& folder, const fs::path& journal) {
  std::error_code error;
  std::vector<fs::path> all = files_of(journal);
  all.insert(all.end(), {folder, folder / "log", journal});
  for (fs::path each : all) {
    // A missing folder will be made in the nearest one that exists.
    each = fs::absolute(each);
    while (!fs::exists(each, error) && each != each.parent_path()) each = each.parent_path();
    if (const std::string why = weakness_of_all(each); !why.empty())
      return Error{
          fmt::format("culprit follows the content of {}, and another user could change it: {}",
                      folder.string(), why)};
  }
  return {};
}

void make_private(const fs::path& journal) {
  for (const fs::path& each : files_of(journal)) {
    struct stat status {};
    if (lstat(each.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
        status.st_uid == geteuid() && (status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
      chmod(each.c_str(), status.st_mode & S_IRWXU);
  }
}

}  // namespace culprit::live
