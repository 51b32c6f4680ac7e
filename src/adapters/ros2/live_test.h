// For tests that speak DDS for real: a domain of their own, contexts with a thread, and waiting for
// events.
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
#include "rtps/test_event_log.h"

namespace culprit::ros2 {

// Options for participants that discover only one another. Aborts the test program when no domain
// is free.
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

inline std::unique_ptr<Participant> join(
    const TestDomain& domain, DiscoveryCallback on_discovery = [](DiscoveryEvent) {}) {
  auto participant = Participant::create(domain.options(), std::move(on_discovery));
  if (!participant) throw std::runtime_error(participant.error());
  return std::move(*participant);
}

inline const rtps::Bytes kSmallPayload{0, 1, 0, 0, 1, 2, 3, 4};

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
  rtps::EventLog<GraphChange>& changes() { return changes_; }

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
  rtps::EventLog<GraphChange> changes_;
  std::unique_ptr<Context> context_;
  std::thread thread_;
};

}  // namespace culprit::ros2
