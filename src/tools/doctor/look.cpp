#include "doctor/look.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include "ros2/node.h"
#include "ros2/process_finder.h"
#include "ros2/service_client.h"
#include "ros2/services.h"

namespace culprit::doctor {
namespace {

constexpr std::size_t kMostStatuses = 10'000;  // the network decides how many there are

// Of the executor's thread, which is this one's.
class Look {
 public:
  Expected<void> open(const ros2::ParticipantOptions& options) {
    ros2::Graph::Options graph;
    graph.listener = [this](const ros2::GraphChange& change) { on_change(change); };
    graph.find_process = [](const ros2::ParticipantInfo& info) {
      return ros2::ProcessFinder().find(info);
    };
    auto context = ros2::Context::create(executor_, options, std::move(graph));
    if (!context) return Error{context.error()};
    context_ = std::move(*context);
    auto node = ros2::Node::create(*context_, {"/", "_culprit_doctor"});
    if (!node) return Error{node.error()};
    node_ = std::move(*node);
    constexpr ros2::Qos kQos{.reliability = ros2::Reliability::kBestEffort, .depth = 100};
    auto diagnostics = node_->create_subscription<ros2::msg::DiagnosticArray>(
        "/diagnostics", kQos,
        [this](const ros2::msg::DiagnosticArray& message) { on_diagnostics(message); });
    if (!diagnostics) return Error{diagnostics.error()};
    diagnostics_ = std::move(*diagnostics);
    picture_.domain = options.domain;
    return {};
  }

  ~Look() {
    clients_.clear();
    diagnostics_.reset();
    node_.reset();
    context_.reset();
  }

  Picture take(Duration time) {
    ros2::TaskGroup tasks(executor_);
    const auto begin = ros2::Executor::Clock::now();
    // By then who is there was discovered.
    tasks.post_at(begin + time / 3, [&] { ask_all(time / 2); });
    tasks.post_at(begin + time, [&] {
      // Their leases may run for 20 s after they were killed.
      context_->forget_ended_namesakes();
      tasks.post([this] {
        picture_.nodes = context_->graph().nodes();
        executor_.stop();
      });
    });
    executor_.run();
    return std::move(picture_);
  }

 private:
  // Every node of rclcpp and rclpy answers questions about its parameters, in the thread that runs
  // its callbacks. The question is about none, and changes nothing.
  void ask_all(Duration patience) {
    for (const auto& [node, endpoints] : context_->graph().nodes()) {
      const std::string service = node.name + "/get_parameters";
      const bool answers = std::ranges::any_of(endpoints, [&](const ros2::GraphEndpoint& each) {
        return each.kind == EndpointKind::kServer && each.name == service;
      });
      if (answers) ask(node, service, patience);
    }
  }

  void ask(const ros2::GraphNode& node, const std::string& service, Duration patience) {
    using Question = ros2::srv::GetParameters;
    auto client = ros2::ServiceClient::create(
        node_->entry(), {service, std::string(Question::kType)}, ros2::qos::kParameterServices);
    if (!client) return;
    clients_.push_back(std::move(*client));
    clients_.back()->call(ros2::encode(Question::Request{}), ros2::Repeat::kUntilAnswered, patience,
                          [this, node, patience](const ros2::CallResult& result) {
                            // Only this outcome comes on the executor's thread. Who was never reached is no proof.
                            if (result.outcome != ros2::CallOutcome::kTimedOut) return;
                            picture_.unanswered[node.name] = {
                                std::chrono::duration<double>(patience).count(),
                                node.pid != 0 && !ros2::ProcessFinder().is_running(node.pid)};
                          });
  }

  void on_change(const ros2::GraphChange& change) {
    const auto* namesakes = std::get_if<ros2::NodeNamesakes>(&change);
    if (namesakes == nullptr) return;
    if (namesakes->others == 0) {
      picture_.namesakes.erase(namesakes->node);
    } else {
      picture_.namesakes[namesakes->node] = namesakes->all;
    }
  }

  void on_diagnostics(const ros2::msg::DiagnosticArray& message) {
    for (const ros2::msg::DiagnosticStatus& status : message.status) {
      if (picture_.statuses.size() >= kMostStatuses && !picture_.statuses.contains(status.name))
        continue;
      picture_.statuses[status.name] = status;
    }
  }

  Picture picture_;
  ros2::Executor executor_;
  std::unique_ptr<ros2::Context> context_;
  std::unique_ptr<ros2::Node> node_;
  std::unique_ptr<ros2::Subscription> diagnostics_;
  std::vector<std::unique_ptr<ros2::ServiceClient>> clients_;
};

}  // namespace

Expected<Picture> look(const ros2::ParticipantOptions& options, Duration time) {
  Look look;
  if (const auto opened = look.open(options); !opened) return Error{opened.error()};
  return look.take(time);
}

}  // namespace culprit::doctor
