// Receives what a running culprit reports: a terminal, for example.
#pragma once

#include <string>

#include "knowledge/event_words.h"

namespace culprit::live {

// A listener may ignore any of these calls.
class Listener {
 public:
  virtual ~Listener() = default;

  // Something happened. `start`: from when people count times.
  virtual void on_event(const Event& /*event*/, const RuleSet& /*rules*/, Time /*start*/) {}
  // Something about culprit itself (announcements.h). `after`: since the start.
  virtual void on_announcement(Duration /*after*/, const EventWords& /*words*/,
                               const std::string& /*text*/) {}
  // Whole lines, of what it finds and begins. From any thread.
  virtual void on_remark(const std::string& /*lines*/) {}
  // A problem at the end, when no other channel can report it.
  virtual void on_trouble(const std::string& /*text*/) {}
};

}  // namespace culprit::live
