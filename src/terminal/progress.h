// How far a long piece of work is, on one line of a terminal.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace culprit {

// "[#######.............]  35 %  454/1296, 4 s left". `elapsed` is what `done - done_before` of
// them took. @pre total > 0
std::string progress_line(std::uint64_t done, std::uint64_t total, std::uint64_t done_before,
                          std::chrono::duration<double> elapsed);

// Draws the line on the standard error stream a few times a second, and when all is done: over and
// over on a terminal, line by line for programs that ask for it.
class Progress {
 public:
  // `done` of `total` were done before.
  Progress(std::uint64_t done, std::uint64_t total);
  ~Progress() { end(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::uint64_t done);
  void end();  // clears the line, before others write

 private:
  using Clock = std::chrono::steady_clock;

  const std::uint64_t done_before_;
  const std::uint64_t total_;
  const bool is_terminal_;
  bool is_shown_;
  const Clock::time_point begin_ = Clock::now();
  Clock::time_point next_ = begin_;
};

}  // namespace culprit
