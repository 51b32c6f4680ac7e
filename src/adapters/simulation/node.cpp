#include "simulation/node.h"

#include "simulation/topic.h"

namespace culprit::simulation {

Duration Span::draw(Random& random) const {
  if (spread == Duration::zero()) return least;
  return least + Duration(static_cast<Duration::rep>(static_cast<double>(spread.count()) *
                                                     random.uniform()));
}

Node::Node(World& world, std::string name, NodeTraits traits)
    : world_(world), name_(std::move(name)), traits_(traits), random_(world.random(name_)) {
  world_.nodes_.push_back(this);
  world_.nodes_by_name_.emplace(name_, this);
}

Node::~Node() {
  std::erase(world_.nodes_, this);
  world_.nodes_by_name_.erase(name_);
}

// ---- the process

void Node::launch() {
  if (process_ != ProcessState::kGone) return;
  process_ = ProcessState::kRunning;
  pid_ = world_.new_pid();
  world_.show([&](Watcher& watcher) { watcher.on_process(*this, ""); });
  while_alive(traits_.start.draw(random_), [this] {
    if (failing_starts_ > 0) {
      --failing_starts_;
      return lose_process("exit code 1");
    }
    appear();
    bring_up();
  });
}

void Node::appear() {
  lifecycle_ = Lifecycle::kUnconfigured;
  parameters_ = defaults_;
  is_in_graph_ = true;
  world_.show([&](Watcher& watcher) { watcher.on_node(*this, true); });
  on_start();
  for (Endpoint* endpoint : endpoints_) endpoint->report();
}

void Node::bring_up() {
  if (traits_.starts_as == Lifecycle::kUnconfigured) return;
  post([this] {
    change(Transition::kConfigure);
    if (traits_.starts_as != Lifecycle::kActive) return;
    while_alive(traits_.configure + traits_.activation_delay,
                [this] { post([this] { change(Transition::kActivate); }); });
  });
}

void Node::disappear() {
  if (!is_in_graph_) return;
  for (Endpoint* endpoint : endpoints_) endpoint->report();
  is_in_graph_ = false;
  world_.show([&](Watcher& watcher) { watcher.on_node(*this, false); });
}

void Node::lose_process(const std::string& remark) {
  process_ = ProcessState::kGone;
  is_hung_ = false;
  waiting_.clear();
  for (Endpoint* endpoint : endpoints_) endpoint->forget();
  free_at_ = {};
  world_.show([&](Watcher& watcher) { watcher.on_process(*this, remark); });
}

void Node::terminate(Action done) {
  if (process_ == ProcessState::kGone) return done();
  world_.after(traits_.end.draw(random_), [this, pid = pid_, done = std::move(done)] {
    if (pid_ == pid && process_ != ProcessState::kGone) {
      lose_process("stopped");
      disappear();
    }
    done();
  });
}

void Node::kill() {
  if (process_ == ProcessState::kGone) return;
  lose_process("killed by signal 9");
  world_.after(kLease, [this, pid = pid_] {
    if (pid_ == pid) disappear();
  });
}

void Node::stop() {
  if (process_ != ProcessState::kRunning) return;
  process_ = ProcessState::kStopped;
  world_.show([&](Watcher& watcher) { watcher.on_process(*this, ""); });
}

void Node::resume() {
  if (process_ != ProcessState::kStopped) return;
  process_ = ProcessState::kRunning;
  world_.show([&](Watcher& watcher) { watcher.on_process(*this, ""); });
  drain();
}

void Node::hang() {
  if (process_ != ProcessState::kGone) is_hung_ = true;
}

void Node::for_each_endpoint(
    const std::function<void(EndpointKind, const std::string&)>& visit) const {
  for (const Endpoint* endpoint : endpoints_) {
    if (endpoint->is_open()) visit(endpoint->kind(), endpoint->name());
  }
}

// ---- the executor

void Node::while_alive(Duration delay, Action action) {
  world_.after(delay, [this, pid = pid_, action = std::move(action)] {
    if (pid_ == pid && process_ != ProcessState::kGone) action();
  });
}

void Node::post(Action work) {
  if (process_ == ProcessState::kGone || !is_in_graph_) return;
  waiting_.push_back(std::move(work));
  drain();
}

void Node::drain() {
  while (!waiting_.empty() && process_ == ProcessState::kRunning && !is_hung_ && !is_in_callback_) {
    if (world_.now() < free_at_) {
      if (std::exchange(is_waking_, true)) return;
      world_.at(free_at_, [this] {
        is_waking_ = false;
        drain();
      });
      return;
    }
    const Action work = std::move(waiting_.front());
    waiting_.pop_front();
    is_in_callback_ = true;
    work();
    is_in_callback_ = false;
  }
}

void Node::occupy(Duration time) { free_at_ = later(free_at(), time); }

void Node::every(Duration first, Duration period, Action action) {
  while_alive(first, [this, period, action = std::move(action)] { tick(period, action); });
}

void Node::tick(Duration period, const Action& action) {
  post(action);
  every(period, action);
}

// ---- lifecycle, parameters

void Node::become(Lifecycle lifecycle) {
  lifecycle_ = lifecycle;
  for (Endpoint* endpoint : endpoints_) endpoint->report();
  world_.show([&](Watcher& watcher) { watcher.on_lifecycle(*this); });
}

bool Node::change(Transition transition) {
  using enum Lifecycle;
  if (transition == Transition::kConfigure && lifecycle_ == kUnconfigured) {
    occupy(traits_.configure);
    on_configure();
    become(kInactive);
  } else if (transition == Transition::kActivate && lifecycle_ == kInactive) {
    on_activate();
    become(kActive);
  } else if (transition == Transition::kDeactivate && lifecycle_ == kActive) {
    on_deactivate();
    become(kInactive);
  } else if (transition == Transition::kCleanup && lifecycle_ == kInactive) {
    become(kUnconfigured);
  } else {
    return false;
  }
  return true;
}

const Value* Node::parameter(const std::string& name) const {
  const auto found = parameters_.find(name);
  return found == parameters_.end() ? nullptr : &found->second;
}

bool Node::set_parameter(const std::string& name, const Value& value) {
  const auto found = parameters_.find(name);
  if (found == parameters_.end() || found->second.index() != value.index() || !on_set(name, value))
    return false;
  assign(name, value);
  return true;
}

bool Node::on_set(const std::string&, const Value&) { return true; }

bool Node::call(const std::string&) { return false; }

void Node::declare(std::string name, Value value) {
  parameters_[name] = value;
  defaults_[std::move(name)] = std::move(value);
}

void Node::set_default(const std::string& name, Value value) { defaults_[name] = std::move(value); }

void Node::assign(const std::string& name, Value value) {
  Value& held = parameters_[name];
  held = std::move(value);
  world_.show([&](Watcher& watcher) { watcher.on_parameter(*this, name, held); });
}

}  // namespace culprit::simulation
