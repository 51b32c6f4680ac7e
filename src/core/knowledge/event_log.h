// The events of the current step, in order.
#pragma once

#include <utility>
#include <vector>

#include "knowledge/event.h"

namespace culprit {

class EventLog {
 public:
  template <class What>
  void tell(Time at, What what) {
    events_.push_back({at, std::move(what)});
  }
  // A new step begins.
  void clear() { events_.clear(); }

  std::vector<Event>::const_iterator begin() const { return events_.begin(); }
  std::vector<Event>::const_iterator end() const { return events_.end(); }
  std::size_t size() const { return events_.size(); }
  bool empty() const { return events_.empty(); }
  const Event& operator[](std::size_t place) const { return events_[place]; }

 private:
  std::vector<Event> events_;
};

}  // namespace culprit
