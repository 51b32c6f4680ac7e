#include "ros2/node.h"

#include <algorithm>
#include <chrono>

#include "ros2/messages.h"
#include "ros2/services.h"

namespace culprit::ros2 {
namespace {

msg::Time now() { return msg::to_time(std::chrono::system_clock::now()); }

// rclcpp names the logger of /a/b/node "a.b.node".
std::string logger_name(const NodeName& node) {
  std::string name = node.full().substr(1);
  std::ranges::replace(name, '/', '.');
  return name;
}

}  // namespace

Expected<std::unique_ptr<Node>> Node::create(Context& context, NodeName name, Extent extent) {
  if (!is_valid_namespace(name.name_space) || !is_valid_node_name(name.name)) {
    return Error{"'" + printable(name.full()) + "' cannot be the name of a node"};
  }
  std::unique_ptr<Node> node(new Node(context, std::move(name)));
  if (extent == Extent::kMinimal) return node;
  if (auto opened = node->open(); !opened) return Error{opened.error()};
  return node;
}

Node::Node(Context& context, NodeName name)
    : entry_(context, std::move(name)),
      parameters_(entry_.name().full(), [this](msg::ParameterEvent event) {
        event.stamp = now();
        if (parameter_events_) parameter_events_->publish(event);
      }) {}

Node::~Node() = default;

Expected<void> Node::open() {
  auto rosout = create_publisher<msg::Log>("/rosout", rtps::qos::kRosout);
  if (!rosout) return Error{rosout.error()};
  rosout_ = std::move(*rosout);
  auto events =
      create_publisher<msg::ParameterEvent>("/parameter_events", rtps::qos::kParameterEvents);
  if (!events) return Error{events.error()};
  parameter_events_ = std::move(*events);
  if (auto opened = open_parameter_services(); !opened) return opened;
  return parameters_.declare("use_sim_time", Value(false));
}

template <class Service>
Expected<void> Node::serve(
    std::string_view name,
    std::function<typename Service::Response(const typename Service::Request&)> handler) {
  auto server = create_service<Service>(name, std::move(handler), rtps::qos::kParameterServices);
  if (!server) return Error{server.error()};
  parameter_services_.push_back(std::move(*server));
  return {};
}

Expected<void> Node::open_parameter_services() {
  for (auto& opened :
       {serve<srv::GetParameters>("~/get_parameters",
                                  [this](const auto& request) {
                                    return srv::GetParameters::Response{
                                        parameters_.get_parameters(request.names)};
                                  }),
        serve<srv::GetParameterTypes>("~/get_parameter_types",
                                      [this](const auto& request) {
                                        return srv::GetParameterTypes::Response{
                                            parameters_.get_types(request.names)};
                                      }),
        serve<srv::SetParameters>("~/set_parameters",
                                  [this](const auto& request) {
                                    srv::SetParameters::Response response;
                                    for (const msg::Parameter& parameter : request.parameters) {
                                      response.results.push_back(parameters_.set({&parameter, 1}));
                                    }
                                    return response;
                                  }),
        serve<srv::SetParametersAtomically>("~/set_parameters_atomically",
                                            [this](const auto& request) {
                                              return srv::SetParametersAtomically::Response{
                                                  parameters_.set(request.parameters)};
                                            }),
        serve<srv::DescribeParameters>("~/describe_parameters",
                                       [this](const auto& request) {
                                         return srv::DescribeParameters::Response{
                                             parameters_.describe(request.names)};
                                       }),
        serve<srv::ListParameters>("~/list_parameters", [this](const auto& request) {
          auto [names, prefixes] = parameters_.list(request.prefixes, request.depth);
          return srv::ListParameters::Response{std::move(names), std::move(prefixes)};
        })}) {
    if (!opened) return opened;
  }
  return {};
}

void Node::log(Severity severity, std::string text) {
  if (!rosout_) return;
  rosout_->publish({.stamp = now(),
                    .level = static_cast<std::uint8_t>(severity),
                    .name = logger_name(entry_.name()),
                    .msg = std::move(text),
                    .file = {},
                    .function = {},
                    .line = 0});
}

}  // namespace culprit::ros2
