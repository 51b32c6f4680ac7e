#include "live/begin_anew.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace culprit::live {
namespace {

std::vector<std::string> own_arguments() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  const std::string all((std::istreambuf_iterator<char>(file)), {});
  std::vector<std::string> arguments;
  for (std::size_t at = 0; at < all.size(); at += arguments.back().size() + 1)
    arguments.emplace_back(all.c_str() + at);
  return arguments;
}

}  // namespace

std::vector<std::string> arguments_of_next(std::vector<std::string> own) {
  std::erase_if(own, [](const std::string& each) {
    return each == "--launch" || each.starts_with("--launch=");
  });
  // It may also stand in the environment or in a file.
  own.emplace_back("--launch=false");
  return own;
}

std::string begin_anew() {
  std::vector<std::string> arguments = arguments_of_next(own_arguments());
  std::vector<char*> pointers;
  for (std::string& each : arguments) pointers.push_back(each.data());
  pointers.push_back(nullptr);
  std::fflush(nullptr);
  // Sockets of the middleware, and locks, are the next one's to take.
  constexpr int kFirst = 3;
  constexpr int kMost = 65536;
  for (int descriptor = kFirst; descriptor < kMost; ++descriptor)
    fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  execv("/proc/self/exe", pointers.data());
  return std::string("culprit cannot restart itself: ") + std::strerror(errno);
}

}  // namespace culprit::live
