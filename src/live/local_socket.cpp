#include "live/local_socket.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <limits>
#include <optional>
#include <signal.h>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <tuple>
#include <unistd.h>

#include "base/environment.h"
#include "owners/file_descriptor.h"

namespace culprit::live {
namespace {

namespace fs = std::filesystem;

constexpr const char* kService = "/run/culprit";
constexpr const char* kOfRoot = "/run/culprit-0";

fs::path folder_in_tmp(std::uint32_t user) { return "/tmp/culprit-" + std::to_string(user); }

// Of this process: the first that applies.
fs::path own_socket_folder() {
  // Several folders are separated by colons.
  const std::string service = environment("RUNTIME_DIRECTORY");
  if (!service.empty()) return service.substr(0, service.find(':'));
  const std::string runtime = environment("XDG_RUNTIME_DIR");
  if (!runtime.empty()) return fs::path(runtime) / "culprit";
  const fs::path of_user = "/run/user/" + std::to_string(geteuid());
  if (access(of_user.c_str(), W_OK) == 0) return of_user / "culprit";
  if (geteuid() == 0 && access("/run", W_OK) == 0) return kOfRoot;
  return folder_in_tmp(geteuid());
}

// Those that other users have made, as far as root looks: any user can make any number of them.
std::vector<fs::path> found_folders(const fs::path& place, const std::string& prefix,
                                    const fs::path& within) {
  constexpr int kMostRead = 100'000;
  constexpr std::size_t kMostFound = 1000;
  std::vector<fs::path> folders;
  std::error_code error;
  int left = kMostRead;
  for (fs::directory_iterator i(place, error);
       !error && i != fs::directory_iterator() && left-- > 0 && folders.size() < kMostFound;
       i.increment(error)) {
    if (i->path().filename().native().starts_with(prefix))
      folders.push_back(within.empty() ? i->path() : i->path() / within);
  }
  return folders;
}

// All folders where a culprit may have its socket.
std::vector<fs::path> socket_folders(const CulpritQuery& query) {
  std::vector<fs::path> folders{own_socket_folder(), kService};
  const auto add = [&](const std::vector<fs::path>& more) {
    folders.insert(folders.end(), more.begin(), more.end());
  };
  std::vector<std::uint32_t> users{geteuid()};
  if (geteuid() == 0) {
    folders.emplace_back(kOfRoot);
    users.insert(users.end(), query.users.begin(), query.users.end());
    add(found_folders("/run/user", "", "culprit"));
    add(found_folders("/tmp", "culprit-", ""));
  }
  for (const std::uint32_t user : users)
    add({"/run/user/" + std::to_string(user) + "/culprit", folder_in_tmp(user)});
  std::sort(folders.begin(), folders.end());
  folders.erase(std::unique(folders.begin(), folders.end()), folders.end());
  return folders;
}

// The owner of the folder; nothing: other users may write there, or it is no folder.
std::optional<std::uint32_t> owner_of(const fs::path& folder) {
  struct stat status {};
  if (lstat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode) ||
      (status.st_mode & (S_IWGRP | S_IWOTH)) != 0)
    return std::nullopt;
  return status.st_uid;
}

bool is_asked(const fs::path& folder, std::uint32_t owner, const CulpritQuery& query) {
  if (owner == geteuid() || owner == 0) return true;
  if (geteuid() != 0) return false;
  return folder == kService || query.is_everybody ||
         std::find(query.users.begin(), query.users.end(), owner) != query.users.end();
}

// The reason why culprit must not listen in this folder; empty: it is ours alone.
std::optional<std::string> objection_to(const fs::path& folder) {
  struct stat status {};
  if (lstat(folder.c_str(), &status) != 0)
    return "the folder '" + folder.string() + "' cannot be made: " + std::strerror(errno);
  if (!S_ISDIR(status.st_mode)) return "'" + folder.string() + "' is no folder";
  if (status.st_uid != geteuid() || (status.st_mode & (S_IWGRP | S_IWOTH)) != 0)
    return "others may write to the folder '" + folder.string() + "'; remove it";
  return std::nullopt;
}

std::optional<int> number_at(std::string_view& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || number < 0) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

// "<domain>-<process>.sock"
std::optional<LocalSocket> read_socket_name(const fs::path& path) {
  const std::string name = path.filename();
  std::string_view rest = name;
  const auto domain = number_at(rest);
  if (!domain || !rest.starts_with('-')) return std::nullopt;
  rest.remove_prefix(1);
  const auto process = number_at(rest);
  if (!process || rest != ".sock") return std::nullopt;
  return LocalSocket{path, static_cast<std::uint32_t>(*domain), *process};
}

// Empty: it is gone meanwhile, or no socket of a culprit.
std::optional<LocalSocket::State> state_of(const fs::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.native().size() >= sizeof address.sun_path) return std::nullopt;
  std::strcpy(address.sun_path, path.c_str());
  const owners::FileDescriptor socket(
      ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
    return LocalSocket::State::kListens;
  switch (errno) {
    case EAGAIN:  // so many wait there already
      return LocalSocket::State::kListens;
    case ECONNREFUSED:
      return LocalSocket::State::kLeft;
    default:
      return std::nullopt;
  }
}

}  // namespace

Expected<fs::path> own_socket(std::uint32_t domain) {
  const fs::path folder = own_socket_folder();
  mkdir(folder.c_str(), S_IRWXU);  // it may be there
  if (auto objection = objection_to(folder)) return Error{std::move(*objection)};
  chmod(folder.c_str(), S_IRWXU);  // systemd's is open to readers unless its unit says otherwise
  fs::path path = folder / (std::to_string(domain) + "-" + std::to_string(getpid()) + ".sock");
  if (path.native().size() >= sizeof sockaddr_un{}.sun_path)
    return Error{"the name '" + path.string() + "' is too long for a socket"};
  // In another container that shares the folder, there may be a process of the same number.
  if (state_of(path) == LocalSocket::State::kListens)
    return Error{"another process listens at '" + path.string() + "'"};
  return path;
}

std::vector<LocalSocket> local_sockets(const CulpritQuery& query) {
  std::vector<LocalSocket> found;
  for (const fs::path& folder : socket_folders(query)) {
    const auto owner = owner_of(folder);
    if (!owner) continue;
    const bool asks = is_asked(folder, *owner, query);
    constexpr int kMostOfOthers = 100;  // they are told of only
    int left = asks ? std::numeric_limits<int>::max() : kMostOfOthers;
    std::error_code error;
    for (fs::directory_iterator i(folder, error);
         !error && i != fs::directory_iterator() && left-- > 0; i.increment(error)) {
      auto socket = read_socket_name(i->path());
      struct stat status {};
      if (!socket || lstat(i->path().c_str(), &status) != 0 || !S_ISSOCK(status.st_mode)) continue;
      const auto state = asks ? state_of(i->path()) : std::optional(LocalSocket::State::kForbidden);
      if (!state) continue;
      socket->user = *owner;
      socket->state = *state;
      found.push_back(std::move(*socket));
    }
  }
  std::sort(found.begin(), found.end(), [](const LocalSocket& a, const LocalSocket& b) {
    return std::tie(a.domain, a.process) < std::tie(b.domain, b.process);
  });
  return found;
}

void remove_left_sockets() {
  for (const LocalSocket& each : local_sockets()) {
    // One that is about to listen does not yet.
    const bool is_gone = kill(each.process, 0) != 0 && errno == ESRCH;
    if (each.state == LocalSocket::State::kLeft && each.user == geteuid() && is_gone)
      unlink(each.path.c_str());
  }
}

}  // namespace culprit::live
