#include "simulation/agenda.h"

#include <algorithm>

namespace culprit::simulation {

void Agenda::add(Time due, Action action) {
  items_.push_back({due, added_++, std::move(action)});
  std::push_heap(items_.begin(), items_.end(), is_after);
}

Action Agenda::take() {
  std::pop_heap(items_.begin(), items_.end(), is_after);
  Action action = std::move(items_.back().action);
  items_.pop_back();
  return action;
}

}  // namespace culprit::simulation
