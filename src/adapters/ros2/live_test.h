// For tests that speak DDS for real: a domain of their own, contexts with a thread, and waiting for
// events.
//
// Nothing here measures time. A wait ends with the event that it waits for, however slow the
// machine is; the time-out is only for tests that fail.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/mutex.h"
#include "ros2/context.h"
#include "ros2/domain_lock.h"
#include "ros2/executor.h"

namespace culprit::ros2 {

inline constexpr std::chrono::seconds kPatience(20);

// Options for participants that only hear one another. Aborts the test program when no domain is
// free.
class TestDomain {
 public:
  ParticipantOptions options() const {
    ParticipantOptions options;
    options.domain = lock_.domain();
    options.reach = Reach::kLocalhost;
    options.gid_size = GidSize::kHumbleAndOlder;
    return options;
  }
  std::uint32_t number() const { return lock_.domain(); }

 private:
  static DomainLock reserve() {
    auto lock = DomainLock::reserve();
    if (!lock) throw std::runtime_error(lock.error());
    return std::move(*lock);
  }

  DomainLock lock_ = reserve();
};

// What happened, in order; written by any thread, awaited by the test.
template <class Event>
class EventLog {
 public:
  void add(Event event) {
    // Notified under the lock: whoever waits may destroy the log as soon as it sees the event.
    const MutexLock lock(mutex_);
    events_.push_back(std::move(event));
    added_.notify_all();
  }

  // Whether `done` became true of all events so far.
  template <class Predicate>
  bool wait(Predicate done) {
    MutexLock lock(mutex_);
    return added_.wait_for(lock, kPatience,
                           [&]() CULPRIT_REQUIRES(mutex_) { return done(events_); });
  }
  bool wait_for_count(std::size_t count) {
    return wait([count](const auto& events) { return events.size() >= count; });
  }
  template <class Predicate>
  bool wait_for_one(Predicate is_it) {
    return wait([&](const auto& events) {
      for (const auto& event : events) {
        if (is_it(event)) return true;
      }
      return false;
    });
  }

  std::vector<Event> all() const {
    const MutexLock lock(mutex_);
    return events_;
  }

 private:
  mutable Mutex mutex_;
  ConditionVariable added_;
  std::vector<Event> events_ CULPRIT_GUARDED_BY(mutex_);
};

// A context whose executor runs on a thread of its own.
class LiveContext {
 public:
  explicit LiveContext(const ParticipantOptions& options, Graph::Options graph = {}) {
    auto context = Context::create(executor_, options, with_log(std::move(graph)));
    if (!context) throw std::runtime_error(context.error());
    context_ = std::move(*context);
    thread_ = std::thread([this] { executor_.run(); });
  }
  ~LiveContext() {
    executor_.stop();
    thread_.join();
  }

  Context& operator*() { return *context_; }
  Context* operator->() { return context_.get(); }
  EventLog<GraphChange>& changes() { return changes_; }

  // Runs `task` on the executor's thread, and waits for it.
  void run(std::function<void()> task) {
    std::promise<void> done;
    TaskGroup tasks(executor_);
    tasks.post([&] {
      task();
      done.set_value();
    });
    done.get_future().wait();
  }

  bool sees_node(const std::string& name) {
    return changes_.wait_for_one([&](const GraphChange& change) {
      const auto* joined = std::get_if<NodeJoined>(&change);
      return joined != nullptr && joined->node.name == name;
    });
  }
  bool sees_process(const std::string& name, int pid) {
    return changes_.wait_for_one([&](const GraphChange& change) {
      const auto* joined = std::get_if<NodeJoined>(&change);
      return joined != nullptr && joined->node.name == name && joined->node.pid == pid;
    });
  }
  bool sees_node_leave(const std::string& name) {
    return changes_.wait_for_one([&](const GraphChange& change) {
      const auto* left = std::get_if<NodeLeft>(&change);
      return left != nullptr && left->node == name;
    });
  }
  bool sees_endpoint(const std::string& node, EndpointKind kind, const std::string& name) {
    return changes_.wait_for_one([&](const GraphChange& change) {
      const auto* joined = std::get_if<EndpointJoined>(&change);
      return joined != nullptr && joined->node == node && joined->endpoint.kind == kind &&
             joined->endpoint.name == name;
    });
  }

 private:
  Graph::Options with_log(Graph::Options graph) {
    graph.listener = [this](const GraphChange& change) { changes_.add(change); };
    return graph;
  }

  Executor executor_;
  EventLog<GraphChange> changes_;
  std::unique_ptr<Context> context_;
  std::thread thread_;
};

}  // namespace culprit::ros2
