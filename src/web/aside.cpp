#include "web/aside.h"

#include <csignal>
#include <exception>
#include <sys/resource.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>

#include "base/text_file.h"
#include "owners/spawn.h"

namespace culprit::web {

Expected<Printed> run_aside(std::vector<std::string> arguments, const TemporaryFolder& folder,
                            int most_seconds) {
  const std::string limit =
      "--cpu=" + std::to_string(most_seconds) + ":" + std::to_string(most_seconds + 1);
  std::vector<std::string> all = {"nice", "-n", "19", "prlimit", limit};
  all.insert(all.end(), arguments.begin(), arguments.end());
  const std::string output = folder / "printed";
  owners::Program program{std::move(all), {}, output};
  program.lifetime = owners::Lifetime::kStarter;
  const auto pid = owners::spawn(program);
  if (!pid) return Error{pid.error()};
  int status = 0;
  waitpid(*pid, &status, 0);
  auto text = read_text(output);
  if (!text) return Error{text.error()};
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    return Error{"it takes the processor longer than " + std::to_string(most_seconds) + " s"};
  if (!WIFEXITED(status)) return Error{arguments.front() + " was killed"};
  return Printed{WEXITSTATUS(status), std::move(*text)};
}

http::Answer FewAtOnce::make(const std::function<http::Answer()>& answer) {
  auto& places = http::client_has_token() ? with_token_ : without_token_;
  if (!places.try_acquire())
    return http::refuse(409, "other answers of this kind are being made; ask again in a moment");
  http::Answer made;
  std::exception_ptr failure;
  try {
    std::thread thread([&] {
      // The priority of this thread alone, and not the lowest: others may wait for a lock that it holds.
      setpriority(PRIO_PROCESS, 0, kLowered);
      try {
        made = answer();
      } catch (...) {
        failure = std::current_exception();
      }
    });
    thread.join();
  } catch (const std::system_error&) {  // the system gives no thread
    failure = std::current_exception();
  }
  places.release();
  if (failure) std::rethrow_exception(failure);
  return made;
}

}  // namespace culprit::web
