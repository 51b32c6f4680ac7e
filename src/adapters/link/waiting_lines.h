// Log lines that wait until the node of their writer is known.
//
// If there are too many, the writer with the most of them loses its oldest one: a flood displaces itself, and hides no line
// of another node.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <unordered_map>
#include <utility>

#include "base/log_level.h"
#include "base/time.h"
#include "rtps/guid.h"

namespace culprit::link {

class WaitingLines {
 public:
  struct Line {
    rtps::Guid writer;
    LogLevel level;
    Time at;
  };

  explicit WaitingLines(std::size_t most) : most_(most) {}

  void add(const Line& line) {
    lines_.push_back(line);
    ++of_writer_[line.writer];
    if (lines_.size() > most_) drop_one();
  }
  // All, the oldest first.
  std::deque<Line> take() {
    of_writer_.clear();
    return std::exchange(lines_, {});
  }

 private:
  void drop_one() {
    const auto loudest =
        std::ranges::max_element(of_writer_, {}, [](const auto& each) { return each.second; });
    const auto oldest = std::ranges::find(lines_, loudest->first, &Line::writer);
    lines_.erase(oldest);
    if (--loudest->second == 0) of_writer_.erase(loudest);
  }

  const std::size_t most_;
  std::deque<Line> lines_;
  std::unordered_map<rtps::Guid, std::size_t> of_writer_;  // their number
};

}  // namespace culprit::link
