// When numbered things want attention next: an indexed binary heap, one deadline for each thing.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/time.h"

namespace culprit {

// Never allocates after construction; set and clear cost O(log n).
class Deadlines {
 public:
  explicit Deadlines(std::size_t count);

  // Replaces the deadline that `index` had. kNever clears it.
  void set(std::size_t index, Time at);
  void clear(std::size_t index) { set(index, kNever); }
  Time at(std::size_t index) const;

  // The earliest deadline; kNever if there is none.
  Time next() const { return heap_.empty() ? kNever : heap_.front().at; }

  // Takes out one thing whose deadline is not after `now`. Equal deadlines come in the order of
  // their numbers.
  std::optional<std::size_t> pop_due(Time now) {
    if (heap_.empty() || heap_.front().at > now) return std::nullopt;
    return pop();
  }

 private:
  struct Entry {
    Time at;
    std::size_t index;
    auto operator<=>(const Entry&) const = default;
  };
  static constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);

  std::size_t pop();
  void place(std::size_t position, Entry entry);
  void sift_up(std::size_t position);
  void sift_down(std::size_t position);
  void remove(std::size_t position);

  std::vector<Entry> heap_;
  std::vector<std::size_t> position_of_;
};

}  // namespace culprit
