// For tests: sockets of another user where a command looks for running culprits.
#pragma once

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <map>
#include <poll.h>
#include <string>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <vector>

namespace culprit::cli {

inline constexpr uid_t kStranger = 65534;  // nobody

enum class Habit : std::uint8_t { kSilent, kTrickles, kEndless, kLies };

inline std::string answer_with(const std::string& body) {
  return "HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: " +
         std::to_string(body.size()) + "\r\n\r\n" + body;
}

// The next data that one of them sends; empty: none.
inline std::string next_piece(Habit habit) {
  switch (habit) {
    case Habit::kSilent:
      return "";
    case Habit::kTrickles:
      return "H";
    case Habit::kEndless:
      return "HTTP/1.1 200 OK\r\nContent-Length: 99999999\r\n\r\n" + std::string(1 << 16, 'x');
    case Habit::kLies:
      break;
  }
  return answer_with(
      R"({"robot": "yard", "process": 1, "domain": 0, "node": "culprit", "order": "paused", "kept": true})");
}

// In a process of the stranger: listens at `count` sockets in `folder`, and goes on until it is killed.
[[noreturn]] inline void be_hostile(const std::filesystem::path& folder, const std::string& domain,
                                    int count) {
  std::error_code error;
  std::filesystem::create_directory(folder, error);
  chmod(folder.c_str(), 0700);
  std::map<int, Habit> listening;
  for (int i = 0; i < count; ++i) {
    const std::string path = folder / (domain + "-" + std::to_string(100'000 + i) + ".sock");
    unlink(path.c_str());
    const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    if (bind(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
        listen(descriptor, 8) != 0)
      _exit(3);
    listening[descriptor] = static_cast<Habit>(i % 4);
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::map<int, Habit> open;
  while (true) {
    std::vector<pollfd> all;
    for (const auto& [descriptor, habit] : listening) all.push_back({descriptor, POLLIN, 0});
    constexpr int kTrickle = 20;  // ms
    poll(all.data(), all.size(), kTrickle);
    for (const pollfd& each : all) {
      if (each.revents == 0) continue;
      const int peer = accept4(each.fd, nullptr, nullptr, SOCK_NONBLOCK);
      if (peer >= 0) open[peer] = listening[each.fd];
    }
    std::erase_if(open, [](const auto& each) {
      const std::string piece = next_piece(each.second);
      const bool is_over =
          !piece.empty() && send(each.first, piece.data(), piece.size(), 0) < 0 && errno != EAGAIN;
      if (is_over) close(each.first);
      return is_over;
    });
  }
}

// Starts it as that user.
inline pid_t start_hostile(const std::filesystem::path& folder, const std::string& domain,
                           int count) {
  const pid_t pid = fork();
  if (pid != 0) return pid;
  if (setresgid(kStranger, kStranger, kStranger) != 0 ||
      setresuid(kStranger, kStranger, kStranger) != 0)
    _exit(2);
  be_hostile(folder, domain, count);
}

}  // namespace culprit::cli
