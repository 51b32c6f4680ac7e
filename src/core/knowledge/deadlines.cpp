#include "knowledge/deadlines.h"

#include "base/invariant.h"

namespace culprit {

Deadlines::Deadlines(std::size_t count) : position_of_(count, kAbsent) { heap_.reserve(count); }

Time Deadlines::at(std::size_t index) const {
  const std::size_t position = position_of_[index];
  return position == kAbsent ? kNever : heap_[position].at;
}

void Deadlines::set(std::size_t index, Time at) {
  const std::size_t position = position_of_[index];
  if (at == kNever) {
    if (position != kAbsent) remove(position);
    return;
  }
  if (position == kAbsent) {
    heap_.push_back({at, index});
    position_of_[index] = heap_.size() - 1;
    sift_up(heap_.size() - 1);
    return;
  }
  heap_[position].at = at;
  sift_up(position);
  sift_down(position_of_[index]);
}

std::size_t Deadlines::pop() {
  CULPRIT_ASSERT(!heap_.empty());
  const std::size_t index = heap_.front().index;
  remove(0);
  return index;
}

void Deadlines::place(std::size_t position, Entry entry) {
  heap_[position] = entry;
  position_of_[entry.index] = position;
}

void Deadlines::sift_up(std::size_t position) {
  const Entry entry = heap_[position];
  while (position > 0) {
    const std::size_t parent = (position - 1) / 2;
    if (heap_[parent] <= entry) break;
    place(position, heap_[parent]);
    position = parent;
  }
  place(position, entry);
}

void Deadlines::sift_down(std::size_t position) {
  const Entry entry = heap_[position];
  for (std::size_t child = 2 * position + 1; child < heap_.size(); child = 2 * position + 1) {
    if (child + 1 < heap_.size() && heap_[child + 1] < heap_[child]) ++child;
    if (entry <= heap_[child]) break;
    place(position, heap_[child]);
    position = child;
  }
  place(position, entry);
}

void Deadlines::remove(std::size_t position) {
  // Another one's deadline would go, and its silence stay unnoticed.
  CULPRIT_ASSERT(position < heap_.size() && position_of_[heap_[position].index] == position);
  position_of_[heap_[position].index] = kAbsent;
  const Entry last = heap_.back();
  heap_.pop_back();
  if (position == heap_.size()) return;
  place(position, last);
  sift_up(position);
  sift_down(position_of_[last.index]);
}

}  // namespace culprit
