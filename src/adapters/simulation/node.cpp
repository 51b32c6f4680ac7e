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
  if (body_.process != ProcessState::kGone) return;
  body_.start(world_.new_pid());
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
  body_.state = Lifecycle::kUnconfigured;
  body_.parameters = defaults_;
  body_.is_in_graph = true;
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
  if (!body_.is_in_graph) return;
  for (Endpoint* endpoint : endpoints_) endpoint->report();
  body_.is_in_graph = false;
  world_.show([&](Watcher& watcher) { watcher.on_node(*this, false); });
}

void Node::lose_process(const std::string& remark) {
  body_.end();
  waiting_.clear();
  for (Endpoint* endpoint : endpoints_) endpoint->forget();
  free_at_ = {};
  world_.show([&](Watcher& watcher) { watcher.on_process(*this, remark); });
}

void Node::terminate(Action done) {
  if (body_.process == ProcessState::kGone) return done();
  world_.after(traits_.end.draw(random_), [this, pid = body_.pid, done = std::move(done)] {
    if (body_.pid == pid && body_.process != ProcessState::kGone) {
      lose_process("stopped");
      disappear();
    }
    done();
  });
}

void Node::kill() {
  if (body_.process == ProcessState::kGone) return;
  lose_process("killed by signal 9");
  world_.after(kLease, [this, pid = body_.pid] {
    if (body_.pid == pid) disappear();
  });
}

void Node::stop() {
  if (body_.process != ProcessState::kRunning) return;
  body_.process = ProcessState::kStopped;
  world_.show([&](Watcher& watcher) { watcher.on_process(*this, ""); });
}

void Node::resume() {
  if (body_.process != ProcessState::kStopped) return;
  body_.process = ProcessState::kRunning;
  world_.show([&](Watcher& watcher) { watcher.on_process(*this, ""); });
  drain();
}

void Node::hang() {
  if (body_.process != ProcessState::kGone) body_.answers = false;
}

void Node::for_each_endpoint(
    const std::function<void(EndpointKind, const std::string&)>& visit) const {
  for (const Endpoint* endpoint : endpoints_) {
    if (endpoint->is_open()) visit(endpoint->kind(), endpoint->name());
  }
}

// ---- the executor

void Node::while_alive(Duration delay, Action action) {
  world_.after(delay, [this, pid = body_.pid, action = std::move(action)] {
    if (body_.pid == pid && body_.process != ProcessState::kGone) action();
  });
}

void Node::post(Action work) {
  if (body_.process == ProcessState::kGone || !body_.is_in_graph) return;
  waiting_.push_back(std::move(work));
  drain();
}

void Node::drain() {
  while (!waiting_.empty() && body_.can_answer() && !is_in_callback_) {
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
  body_.state = lifecycle;
  for (Endpoint* endpoint : endpoints_) endpoint->report();
  world_.show([&](Watcher& watcher) { watcher.on_lifecycle(*this); });
}

bool Node::change(Transition transition) {
  const auto next = after(transition, body_.state);
  if (!next) return false;
  if (transition == Transition::kConfigure) {
    occupy(traits_.configure);
    on_configure();
  } else if (transition == Transition::kActivate) {
    on_activate();
  } else if (transition == Transition::kDeactivate) {
    on_deactivate();
  }
  become(*next);
  return true;
}

bool Node::set_parameter(const std::string& name, const Value& value) {
  const Value* held = parameter(name);
  if (held == nullptr || held->index() != value.index() || !on_set(name, value)) return false;
  assign(name, value);
  return true;
}

bool Node::on_set(const std::string&, const Value&) { return true; }

bool Node::call(const std::string&) { return false; }

void Node::declare(std::string name, Value value) {
  body_.parameters[name] = value;
  defaults_[std::move(name)] = std::move(value);
}

void Node::set_default(const std::string& name, Value value) { defaults_[name] = std::move(value); }

void Node::assign(const std::string& name, Value value) {
  Value& held = body_.parameters[name];
  held = std::move(value);
  world_.show([&](Watcher& watcher) { watcher.on_parameter(*this, name, held); });
}

}  // namespace culprit::simulation
