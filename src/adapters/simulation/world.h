// A simulated world: its clock, its agenda, its nodes, and its watchers.
//
// Discrete-event simulation: time jumps from one thing that is due to the next. The same seed gives
// the same world, bit for bit, on every machine.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "robot/observation.h"
#include "simulation/agenda.h"
#include "simulation/random.h"

namespace culprit::simulation {

class ModeManager;
class Node;
class TopicBase;

// Receives the changes of nodes that are visible from outside. Calls come in the order of time.
class Watcher {
 public:
  virtual ~Watcher() = default;
  virtual void on_node(const Node&, bool /*is_there*/) {}
  virtual void on_endpoint(const Node&, EndpointKind, const std::string& /*name*/,
                           bool /*is_there*/) {}
  virtual void on_sample(const TopicBase&) {}
  // A field of a sample, right after it, if a watcher wants it (TopicBase::watch_field).
  virtual void on_field(const TopicBase&, const std::string& /*field*/, const Value&) {}
  virtual void on_diagnostic(std::string_view /*status*/, std::string_view /*key*/, const Value&) {}
  virtual void on_level(std::string_view /*status*/, std::uint8_t /*level*/) {}
  virtual void on_parameter(const Node&, const std::string& /*name*/, const Value&) {}
  virtual void on_lifecycle(const Node&) {}
  virtual void on_process(const Node&, const std::string& /*remark*/) {}
};

class World {
 public:
  explicit World(std::uint64_t seed) : seed_(seed) {}
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  Time now() const { return now_; }

  // A separate source of random numbers for each `name`, so that one more draw in one place changes
  // nothing elsewhere.
  Random random(std::string_view name) const;

  // Does `action` at `due`, or now if that is past.
  void at(Time due, Action action) { agenda_.add(std::max(due, now_), std::move(action)); }
  void after(Duration delay, Action action) { at(later(now_, delay), std::move(action)); }

  // Does the next thing if it is due not after `until`, and gives whether there was one.
  bool step(Time until);
  // Does everything that is due not after `until`. Then it is `until`.
  void run(Time until);
  // It is `time` now. No action may be due before.
  void set_time(Time time) { now_ = std::max(now_, time); }

  // Null if there is none of this name.
  Node* node(std::string_view name) const;
  TopicBase* topic(std::string_view name) const;
  const std::vector<Node*>& nodes() const { return nodes_; }

  // Null if no mode manager serves this name.
  ModeManager* modes_of(std::string_view system) const;
  const std::map<std::string, ModeManager*, std::less<>>& systems() const { return systems_; }

  // A watcher must outlive its watching.
  void watch(Watcher& watcher) { watchers_.push_back(&watcher); }
  void unwatch(Watcher& watcher) { std::erase(watchers_, &watcher); }
  // Calls `tell(watcher)` for each, in the order of their coming.
  template <class Tell>
  void show(const Tell& tell) const {
    for (Watcher* watcher : watchers_) tell(*watcher);
  }
  // Something was published on /diagnostics.
  void diagnose(std::string_view status, std::string_view key, const Value& value) const {
    show([&](Watcher& watcher) { watcher.on_diagnostic(status, key, value); });
  }
  void diagnose(std::string_view status, std::uint8_t level) const {
    show([&](Watcher& watcher) { watcher.on_level(status, level); });
  }

 private:
  friend class ModeManager;
  friend class Node;
  friend class TopicBase;

  int new_pid() { return ++last_pid_; }

  std::uint64_t seed_;
  Time now_{};
  Agenda agenda_;
  std::vector<Node*> nodes_;  // in the order of their making
  std::map<std::string, Node*, std::less<>> nodes_by_name_;
  std::map<std::string, TopicBase*, std::less<>> topics_;
  std::map<std::string, ModeManager*, std::less<>> systems_;
  std::vector<Watcher*> watchers_;
  int last_pid_ = 100;
};

}  // namespace culprit::simulation
