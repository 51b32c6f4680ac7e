// Where a running culprit is asked on this machine: a unix socket that only its user, and root, may
// open.
//
// It is called "<domain>-<process>.sock" and is in the first of these folders that there is:
//
//     $RUNTIME_DIRECTORY        of a service of systemd: /run/culprit
//     $XDG_RUNTIME_DIR/culprit  of a user who is logged in
//     /run/user/<uid>/culprit   likewise, where the variable was lost (cron, sudo)
//     /tmp/culprit-<uid>        elsewhere: in a container, say
//
// Several culprits have a socket each. Whoever is killed leaves its socket behind; nobody answers there, and the
// next culprit removes it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/expected.h"

namespace culprit::live {

// Where this process is to listen; makes the folder. Errors: the folder cannot be made, belongs to
// somebody else, or others may write there; its name is too long for a socket; somebody listens there.
Expected<std::filesystem::path> own_socket(std::uint32_t domain);

struct LocalSocket {
  enum class State : std::uint8_t {
    kListens,   // a process is there; whether it answers is another matter
    kLeft,      // nobody listens: that process has ended without a word
    kForbidden  // it is another user's
  };
  std::filesystem::path path;
  std::uint32_t domain = 0;
  int process = 0;
  std::uint32_t user = 0;  // whose it is
  State state = State::kListens;
};

// All of this user's, and those of others that this user can see; by domain and process. Root sees all.
std::vector<LocalSocket> local_sockets();

// Removes those that processes of this user have left behind.
void remove_left_sockets();

}  // namespace culprit::live
