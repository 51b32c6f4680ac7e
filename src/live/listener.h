// Who is told what a running culprit has to say: a terminal, say.
#pragma once

#include <string>

#include "knowledge/event_words.h"

namespace culprit::live {

// Nothing of it has to be listened to.
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
  // What went wrong at the end, when nothing else can tell it any more.
  virtual void on_trouble(const std::string& /*text*/) {}
};

}  // namespace culprit::live
