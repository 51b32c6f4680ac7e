// The pending actions of a simulated world, in the order of time.
//
// Actions that are due at the same time are done in the order in which they were added. So a run is
// the same on every machine.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/time.h"

namespace culprit::simulation {

using Action = std::function<void()>;

class Agenda {
 public:
  void add(Time due, Action action);

  // When the next thing is due; kNever if there is none.
  Time next() const { return items_.empty() ? kNever : items_.front().due; }

  // Takes the next thing out. There must be one.
  Action take();

 private:
  struct Item {
    Time due;
    std::uint64_t number = 0;
    Action action;
  };
  static bool is_after(const Item& a, const Item& b) {
    return a.due != b.due ? a.due > b.due : a.number > b.number;
  }

  std::vector<Item> items_;  // a heap, the next one first
  std::uint64_t added_ = 0;
};

}  // namespace culprit::simulation
