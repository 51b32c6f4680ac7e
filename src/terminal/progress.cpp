#include "terminal/progress.h"

#include <cmath>
#include <cstdio>
#include <unistd.h>

#include <fmt/core.h>

#include "base/environment.h"
#include "base/invariant.h"

namespace culprit {
namespace {

constexpr std::size_t kWidth = 20;
constexpr std::chrono::milliseconds kPause{200};

std::string in_words(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

std::string progress_line(std::uint64_t done, std::uint64_t total, std::uint64_t done_before,
                          std::chrono::duration<double> elapsed) {
  CULPRIT_ASSERT(total > 0);
  const double share = static_cast<double>(done) / static_cast<double>(total);
  const auto filled = static_cast<std::size_t>(share * kWidth);
  std::string line =
      fmt::format("[{}{}] {:>3} %  {}/{}", std::string(filled, '#'),
                  std::string(kWidth - filled, '.'), static_cast<int>(share * 100), done, total);
  if (done > done_before) {
    const double each = elapsed.count() / static_cast<double>(done - done_before);
    line += ", " + in_words(each * static_cast<double>(total - done)) + " left";
  }
  return line;
}

Progress::Progress(std::uint64_t done, std::uint64_t total)
    : done_before_(done),
      total_(total),
      is_terminal_(isatty(STDERR_FILENO) != 0),
      is_shown_(total > 0 && (is_terminal_ || environment(kProgressVariable) == "lines")) {}

void Progress::end() {
  if (is_shown_ && is_terminal_) fmt::print(stderr, "\r\033[K");
  is_shown_ = false;
}

void Progress::show(std::uint64_t done) {
  const auto now = Clock::now();
  if (!is_shown_ || (now < next_ && done < total_)) return;
  next_ = now + kPause;
  const std::string line = progress_line(done, total_, done_before_, now - begin_);
  fmt::print(stderr, "{}{}{}", is_terminal_ ? "\r\033[K" : "", line, is_terminal_ ? "" : "\n");
}

}  // namespace culprit
