#include "owners/process_end.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdint>
#include <optional>
#include <sys/ioctl.h>
#include <sys/wait.h>

#include "owners/proc.h"

namespace culprit::owners {
namespace {

constexpr std::array kPolite = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};

// linux/pidfd.h of 6.15, which the headers of the distribution do not have yet.
struct PidfdInfo {
  std::uint64_t mask = 0;
  std::uint64_t control_group = 0;
  std::uint32_t ids[11] = {};
  std::int32_t exit_code = 0;
};
static_assert(sizeof(PidfdInfo) == 64);
constexpr std::uint64_t kExit = 1u << 3;
constexpr unsigned long kGetInfo = _IOWR(0xFF, 11, PidfdInfo);

// Once its parent has received it; an older kernel gives none.
std::optional<int> status_by_pidfd(int pidfd) {
  PidfdInfo info;
  info.mask = kExit;
  const bool is_told = ioctl(pidfd, kGetInfo, &info) == 0 && (info.mask & kExit) != 0;
  return is_told ? std::optional(info.exit_code) : std::nullopt;
}

ProcessEnd by_status(int status) {
  return WIFSIGNALED(status) ? killed(WTERMSIG(status)) : exited(WEXITSTATUS(status));
}

}  // namespace

ProcessEnd exited(int code) {
  const bool passes_on = std::ranges::any_of(
      kPolite, [&](int signal) { return code == 128 + signal || code == 256 - signal; });
  return {"exit code " + std::to_string(code),
          code == 0 || passes_on ? Cause::kWish : Cause::kFault};
}

ProcessEnd killed(int signal) {
  const bool is_polite = std::ranges::find(kPolite, signal) != kPolite.end();
  return {"killed by signal " + std::to_string(signal), is_polite ? Cause::kWish : Cause::kFault};
}

// Its parent may receive it between the two.
ProcessEnd end_of(int pid, int pidfd) {
  if (const auto status = status_by_pidfd(pidfd)) return by_status(*status);
  const auto unheard = status_of_zombie(pid);
  if (const auto status = status_by_pidfd(pidfd)) return by_status(*status);
  return unheard ? by_status(*unheard) : ProcessEnd{};
}

}  // namespace culprit::owners
