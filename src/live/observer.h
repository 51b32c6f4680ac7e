// Follows the management of a robot: a page in a browser, for example.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "knowledge/event_words.h"
#include "manager/manager.h"
#include "manager/runtime.h"

namespace culprit::ros2 {
class NodeEntry;
}

namespace culprit::live {

// All members are called on the thread that manages, and must not block it. One observer sees the
// sessions of a run one after the other.
class Observer {
 public:
  virtual ~Observer() = default;

  // Remarks on nodes that the manager does not know of, by full name.
  using Remarks = std::map<std::string, std::string>;

  // Culprit's own node exists, for publishers of culprit's own data, until leaves() is called.
  virtual void joined(ros2::NodeEntry& /*node*/) {}
  virtual void leaves() {}
  // A manager begins. Both exist until the last step that is reported. People count times from
  // `start`, which is the same for all sessions of a run.
  virtual void begins(const Manager& manager, std::function<Remarks()> remarks, Time start) = 0;
  // It did a step, and its commands have gone out.
  virtual void stepped(const Runtime::Step& step) = 0;
  // When it wants a step reported even if nothing happens.
  virtual Time next_look() const = 0;
  // Something about culprit itself (announcements.h).
  virtual void announced(Time at, const EventWords& words, const std::string& text) = 0;
};

}  // namespace culprit::live
