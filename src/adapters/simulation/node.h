// A simulated ROS 2 node with a process of its own.
//
// Like a real one it has
// - a process that takes time to start and to stop, that can be killed, stopped and hung, and that
//   forgets everything when it is gone;
// - one executor thread: while a callback runs, all later ones wait;
// - a lifecycle, parameters, and topics that it uses while it is configured or active.
//
// A model of a node derives from this class and overrides what happens in it.
#pragma once

#include <deque>
#include <map>
#include <string>

#include "simulation/body.h"
#include "simulation/world.h"

namespace culprit::simulation {

// A time that varies, evenly within `spread` from `least` on.
struct Span {
  Duration least{};
  Duration spread{};

  Duration draw(Random& random) const;
};

// How a node's process comes and goes, and how it serves.
struct NodeTraits {
  Span start;                                // from the launch until the node is in the graph
  Duration configure{};                      // a blocking callback
  Duration activation_delay{};               // from inactive to active, by itself, after a start
  Lifecycle starts_as = Lifecycle::kActive;  // the state that it brings itself to after a start
  Span end;                                  // from being asked to end until the process is gone
  Span service;                              // one way of a request, or of its reply
  double deafness = 0;                       // the probability that a request is never answered
};

class Endpoint;

class Node {
 public:
  // A killed process does not announce its end: its node stays in the graph until its lease is over
  // (the default of Fast DDS).
  static constexpr Duration kLease = std::chrono::seconds(20);

  // `name` is the full name, "/namespace/name". `world` must outlive the node.
  Node(World& world, std::string name, NodeTraits traits);
  virtual ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  const std::string& name() const { return name_; }
  const NodeTraits& traits() const { return traits_; }
  World& world() const { return world_; }
  Random& random() { return random_; }

  // ---- the process

  ProcessState process() const { return body_.process; }
  int pid() const { return body_.pid; }
  bool is_in_graph() const { return body_.is_in_graph; }
  // Starts the process if it has exited. The node comes into the graph after traits().start.
  void launch();
  // Asks the process to end. `done` is called when it has exited, at once if it had.
  void terminate(Action done);
  void kill();    // SIGKILL
  void stop();    // SIGSTOP
  void resume();  // SIGCONT
  void hang();    // the executor never comes back from a callback; a new process is well
  void fail_starts(int count) { failing_starts_ = count; }  // the next ones crash

  // Calls `visit(kind, name)` for each topic that it uses now.
  void for_each_endpoint(const std::function<void(EndpointKind, const std::string&)>& visit) const;

  // ---- what others do with it

  // Has the executor do `work` when its turn comes. Dropped if the process ends before.
  void post(Action work);
  // When the callback under way is over; now if there is none.
  Time free_at() const { return std::max(world_.now(), free_at_); }

  Lifecycle lifecycle() const { return body_.state; }
  // Gives whether the transition is possible and was made.
  bool change(Transition transition);

  // Whether its processes have a parameter of this name.
  bool has(const std::string& parameter) const { return defaults_.contains(parameter); }
  // Null if there is none of this name.
  const Value* parameter(const std::string& name) const { return body_.parameter(name); }
  const std::map<std::string, Value>& parameters() const { return body_.parameters; }
  // Its answer to ReadLifecycle, ReadParameter and Probe.
  Answer read(const decltype(Command::what)& request) { return body_.answer(request); }
  // Gives whether the node has it, and accepts the value.
  bool set_parameter(const std::string& name, const Value& value);
  // Gives whether it has such a routine, and it succeeded.
  virtual bool call(const std::string& service);

  bool is_active() const { return body_.state == Lifecycle::kActive; }

 protected:
  // The behaviour of a model. Called while the process runs.
  virtual void on_start() {}  // a new process: whatever the old one remembered is forgotten
  virtual void on_configure() {}
  virtual void on_activate() {}
  virtual void on_deactivate() {}
  // `value` was accepted. False: it is refused after all.
  virtual bool on_set(const std::string& name, const Value& value);

  // A parameter and its value in a new process.
  void declare(std::string name, Value value);
  // A value that the next process will begin with, as if it were in the node's configuration file.
  void set_default(const std::string& name, Value value);
  // A change by the node itself.
  void assign(const std::string& name, Value value);

  // The callback under way takes this long. Its messages go out afterwards.
  void occupy(Duration time);
  // Calls `action` every `period` of robot time while the process lives, on the executor; the first
  // time after `first`.
  void every(Duration first, Duration period, Action action);
  void every(Duration period, Action action) { every(period, period, std::move(action)); }

 private:
  friend class Endpoint;
  void become(Lifecycle lifecycle);
  void appear();
  void disappear();
  void lose_process(const std::string& remark);
  void bring_up();
  // Does `action` after `delay`, unless the process has become another by then.
  void while_alive(Duration delay, Action action);
  void drain();
  void tick(Duration period, const Action& action);

  World& world_;
  std::string name_;
  NodeTraits traits_;
  Random random_;

  Body body_{.process = ProcessState::kGone,
             .is_in_graph = false,
             .state = Lifecycle::kUnconfigured,
             .parameters = {},
             .mode = {}};
  int failing_starts_ = 0;

  Time free_at_{};  // when the callback under way is over
  std::deque<Action> waiting_;
  bool is_in_callback_ = false;
  bool is_waking_ = false;  // drain() is due at free_at_

  std::map<std::string, Value> defaults_;
  std::vector<Endpoint*> endpoints_;
};

}  // namespace culprit::simulation
