// Where a running culprit is asked on this machine: a unix socket that only its user, and root, may
// open.
//
// It is called "<domain>-<process>.sock" and is in the first of these folders that there is:
//
//     $RUNTIME_DIRECTORY        of a service of systemd: /run/culprit
//     $XDG_RUNTIME_DIR/culprit  of a user who is logged in
//     /run/user/<uid>/culprit   likewise, where the variable was lost (cron, sudo)
//     /run/culprit-0            of root: no other user can be there first
//     /tmp/culprit-<uid>        elsewhere: in a container, say
//
// The folder has the mode 0700. Several culprits have a socket each. One that is killed leaves its socket behind;
// no process listens there, and the next culprit removes it.
//
// Any user can listen in a folder of such a name, and be silent or lie there. So a folder counts only if it
// belongs to the asking user or to root, if no other user may write to it, and if it is no link. Root may also ask other users' culprits; which, is root's
// decision (`CulpritQuery`), but for /run/culprit: only root can have given that to a user.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/expected.h"

namespace culprit::live {

// Where this process is to listen; makes the folder. Errors: the folder cannot be made, belongs to
// another user, or others may write there; its name is too long for a socket; another process listens there.
Expected<std::filesystem::path> own_socket(std::uint32_t domain);

struct LocalSocket {
  enum class State : std::uint8_t {
    kListens,   // a process is there; whether it answers is another matter
    kLeft,      // no process listens: the one that did has ended without a word
    kForbidden  // of a user who is not asked; nothing more is known of it
  };
  std::filesystem::path path;
  std::uint32_t domain = 0;
  int process = 0;
  std::uint32_t user = 0;  // whose folder it is in
  State state = State::kListens;
};

// Further users whose culprits root asks, beside its own and that in /run/culprit. It has no effect for other users.
struct CulpritQuery {
  std::vector<std::uint32_t> users{};
  bool is_everybody = false;
};

// Those that are asked, and those of others that this user can see; by domain and process.
std::vector<LocalSocket> local_sockets(const CulpritQuery& query = {});

// Removes those that processes of this user have left behind.
void remove_left_sockets();

}  // namespace culprit::live
