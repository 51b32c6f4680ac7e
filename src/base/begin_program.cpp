#include "base/begin_program.h"

#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace culprit {

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

// On a thread of its own: a thread that gave up its ambient capabilities does not get them back.
Expected<int> begin_program(std::vector<std::string> words, std::vector<std::string> environment,
                            const ProgramFiles& open) {
  const std::vector<char*> arguments = pointers_to(words);
  const std::vector<char*> variables = pointers_to(environment);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  if (open.in < 0) {
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  } else {
    posix_spawn_file_actions_adddup2(&files, open.in, STDIN_FILENO);
  }
  posix_spawn_file_actions_adddup2(&files, open.out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, open.err, STDERR_FILENO);
  if (open.socket >= 0) posix_spawn_file_actions_adddup2(&files, open.socket, kSocketOfProgram);
  posix_spawn_file_actions_addclosefrom_np(
      &files, open.socket >= 0 ? kSocketOfProgram + 1 : STDERR_FILENO + 1);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSID);
  pid_t pid = 0;
  int why = 0;
  try {
    std::thread([&] {
      prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
      why =
          posix_spawnp(&pid, arguments[0], &files, &attributes, arguments.data(), variables.data());
    }).join();
  } catch (const std::system_error& no_thread) {
    why = no_thread.code().value();
  }
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (why != 0) return Error{words.front() + " cannot be run: " + std::strerror(why)};
  return pid;
}

}  // namespace culprit
