// A small ROS 2 node, as the tools of ROS 2 expect one: a name in the graph, /rosout,
// /parameter_events, the six parameter services, use_sim_time. On it: publishers, subscriptions,
// services and clients; timers are in timer.h.
//
//     Executor executor;
//     auto context = Context::create(executor, {.domain = 0});
//     auto node = Node::create(**context, {"/robot", "camera"});
//     auto rate = (*node)->create_publisher<msg::Float64>("~/rate");
//     auto heard = (*node)->create_subscription<msg::Float64>(
//         "/light", qos::kSensorData, [&](const msg::Float64& light) { rate->publish(light); });
//     executor.run();    // until stop()
//
// Everything calls back on the executor's thread unless it says otherwise. Parameters belong to
// that thread (before it runs, to the thread that sets the node up). Errors are bad names, or what
// the middleware refuses.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/expected.h"
#include "base/units.h"
#include "ros2/context.h"
#include "ros2/parameter_store.h"
#include "ros2/publisher.h"
#include "ros2/service_client.h"
#include "ros2/service_server.h"
#include "ros2/subscription.h"

namespace culprit::ros2 {

// rcl_interfaces/msg/Log
enum class Severity : std::uint8_t {
  kDebug = 10,
  kInfo = 20,
  kWarn = 30,
  kError = 40,
  kFatal = 50
};

// A client of a known type; its answers come on the executor's thread.
template <class Service>
class Client {
 public:
  struct Answer {
    CallOutcome outcome;
    std::optional<typename Service::Response> response;  // nothing unless answered, and well
  };
  using Callback = std::function<void(const Answer&)>;

  Client(Executor& executor, std::unique_ptr<ServiceClient> raw)
      : tasks_(executor), raw_(std::move(raw)) {}
  ~Client() { tasks_.close(); }

  void call(const typename Service::Request& request, Repeat repeat, Duration timeout,
            Callback callback) {
    raw_->call(rtps::encode(request), repeat, timeout,
               [this, callback = std::move(callback)](const CallResult& result) {
                 Answer answer{result.outcome, {}};
                 if (result.outcome == CallOutcome::kAnswered)
                   answer.response = rtps::decode<typename Service::Response>(result.reply);
                 tasks_.post([callback, answer = std::move(answer)] { callback(answer); });
               });
  }

 private:
  TaskGroup tasks_;  // outlives the one that posts to it
  std::unique_ptr<ServiceClient> raw_;
};

class Node {
 public:
  // A minimal node has a name, and the endpoints that it creates: no others that every other process
  // would have to discover. nothing of its own that every other process would have to discover. It
  // does not publish to /rosout, and serves no parameters.
  enum class Extent : std::uint8_t { kWhole, kMinimal };
  // The context outlives the node, the node everything that it created.
  static Expected<std::unique_ptr<Node>> create(Context& context, NodeName name,
                                                Extent extent = Extent::kWhole);
  ~Node();

  Context& context() { return entry_.context(); }
  NodeEntry& entry() { return entry_; }
  const NodeName& name() const { return entry_.name(); }
  ParameterStore& parameters() { return parameters_; }

  // To /rosout, unless it only looks. From any thread.
  void log(Severity severity, std::string text);

  template <class Message>
  Expected<Publisher<Message>> create_publisher(std::string_view topic,
                                                const rtps::Qos& qos = rtps::qos::kDefault) {
    auto raw = RawPublisher::create(entry_, topic, Message::kType, qos);
    if (!raw) return Error{raw.error()};
    return Publisher<Message>(std::move(*raw));
  }

  // Messages that are not well-formed, or larger than their type may be (kLargest), are left out.
  template <class Message>
  Expected<std::unique_ptr<Subscription>> create_subscription(
      std::string_view topic, const rtps::Qos& qos, std::function<void(const Message&)> callback) {
    return Subscription::create(entry_, topic, Message::kType, qos,
                                [callback = std::move(callback)](rtps::ByteView payload) {
                                  if constexpr (requires { Message::kLargest; }) {
                                    if (payload.size() > Message::kLargest) return;
                                  }
                                  if (const auto message = rtps::decode<Message>(payload))
                                    callback(*message);
                                });
  }

  template <class Service>
  Expected<std::unique_ptr<ServiceServer>> create_service(
      std::string_view name,
      std::function<typename Service::Response(const typename Service::Request&)> handler,
      const rtps::Qos& qos = rtps::qos::kServices) {
    const auto resolved = resolve_name(name, entry_.name());
    if (!resolved) return Error{resolved.error()};
    return ServiceServer::create(entry_, {*resolved, std::string(Service::kType)}, qos,
                                 [handler = std::move(handler)](rtps::ByteView request) {
                                   const auto decoded =
                                       rtps::decode<typename Service::Request>(request);
                                   return decoded ? rtps::encode(handler(*decoded)) : rtps::Bytes();
                                 });
  }

  template <class Service>
  Expected<std::unique_ptr<Client<Service>>> create_client(
      std::string_view name, const rtps::Qos& qos = rtps::qos::kServices) {
    const auto resolved = resolve_name(name, entry_.name());
    if (!resolved) return Error{resolved.error()};
    auto raw = ServiceClient::create(entry_, {*resolved, std::string(Service::kType)}, qos);
    if (!raw) return Error{raw.error()};
    return std::make_unique<Client<Service>>(context().executor(), std::move(*raw));
  }

 private:
  Node(Context& context, NodeName name);
  Expected<void> open();
  Expected<void> open_parameter_services();
  template <class Service>
  Expected<void> serve(
      std::string_view name,
      std::function<typename Service::Response(const typename Service::Request&)> handler);

  NodeEntry entry_;
  ParameterStore parameters_;
  std::optional<Publisher<msg::Log>> rosout_;
  std::optional<Publisher<msg::ParameterEvent>> parameter_events_;
  std::vector<std::unique_ptr<ServiceServer>> parameter_services_;
};

}  // namespace culprit::ros2
