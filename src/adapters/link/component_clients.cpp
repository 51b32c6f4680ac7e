#include "link/component_clients.h"

#include <utility>

#include "ros2/services.h"

namespace culprit::link {

ComponentClients::ComponentClients(ros2::NodeEntry& self, std::string node,
                                   const ComponentNeeds& needs, Inbox& inbox)
    : self_(self), node_(std::move(node)), needs_(needs), inbox_(inbox) {}

void ComponentClients::ask_only(const rtps::GuidPrefix& participant) {
  const MutexLock lock(mutex_);
  holder_ = participant;
  for (const auto* client :
       {&lifecycle_, &lifecycle_reader_, &parameters_, &parameter_reader_, &parameter_names_})
    if (*client) (*client)->ask_only(participant);
  for (const auto& [name, client] : routines_)
    if (client) client->ask_only(participant);
}

void ComponentClients::modes_come_from(const rtps::GuidPrefix& participant) {
  const MutexLock lock(mutex_);
  mode_holder_ = participant;
  if (modes_) modes_->ask_only(participant);
}

bool ComponentClients::has_lifecycle() {
  const MutexLock lock(mutex_);
  return lifecycle_ || lifecycle_reader_;
}

ros2::ServiceClient* ComponentClients::make(std::unique_ptr<ros2::ServiceClient>& client,
                                            const std::string& service, std::string_view type,
                                            const rtps::Qos& qos,
                                            std::optional<ros2::ServiceClient::Probe> probe) {
  const MutexLock lock(mutex_);
  if (client) return client.get();
  const ros2::ServiceName name{service, std::string(type)};
  return keep(client, service,
              probe ? ros2::ServiceClient::create(self_, name, qos, std::move(*probe))
                    : ros2::ServiceClient::create(self_, name, qos));
}

ros2::ServiceClient* ComponentClients::make_reader(std::unique_ptr<ros2::ServiceClient>& client,
                                                   const std::string& service,
                                                   std::string_view type, const rtps::Qos& qos) {
  const MutexLock lock(mutex_);
  if (client) return client.get();
  return keep(
      client, service,
      ros2::ServiceClient::create(self_, {service, std::string(type)}, qos, rtps::Haste::kSoon));
}

ros2::ServiceClient* ComponentClients::keep(std::unique_ptr<ros2::ServiceClient>& client,
                                            const std::string& service,
                                            Expected<std::unique_ptr<ros2::ServiceClient>> made) {
  if (!made) {
    inbox_.put(LinkTrouble{"cannot call " + service + ": " + made.error()});
    return nullptr;
  }
  client = std::move(*made);
  const auto& holder = &client == &modes_ ? mode_holder_ : holder_;
  if (holder) client->ask_only(*holder);
  return client.get();
}

ros2::ServiceClient* ComponentClients::lifecycle() {
  return make(lifecycle_, node_ + "/change_state", ros2::srv::ChangeState::kType,
              rtps::qos::kServices,
              {{{node_ + "/get_state", std::string(ros2::srv::GetState::kType)},
                rtps::encode(ros2::srv::GetState::Request{})}});
}

ros2::ServiceClient* ComponentClients::lifecycle_reader() {
  if (!needs_.changes_lifecycle)
    return make_reader(lifecycle_reader_, node_ + "/get_state", ros2::srv::GetState::kType,
                       rtps::qos::kServices);
  ros2::ServiceClient* client = lifecycle();
  return client == nullptr ? nullptr : client->probe();
}

ros2::ServiceClient* ComponentClients::parameters() {
  return make(parameters_, node_ + "/set_parameters", ros2::srv::SetParameters::kType,
              rtps::qos::kParameterServices,
              {{{node_ + "/get_parameters", std::string(ros2::srv::GetParameters::kType)},
                rtps::encode(ros2::srv::GetParameters::Request{})}});
}

ros2::ServiceClient* ComponentClients::parameter_reader() {
  if (!needs_.sets_parameters)
    return make_reader(parameter_reader_, node_ + "/get_parameters",
                       ros2::srv::GetParameters::kType, rtps::qos::kParameterServices);
  ros2::ServiceClient* client = parameters();
  return client == nullptr ? nullptr : client->probe();
}

ros2::ServiceClient* ComponentClients::modes() {
  return make(modes_, node_ + "/change_mode", ros2::srv::ChangeMode::kType, rtps::qos::kServices,
              {{{node_ + "/get_mode", std::string(ros2::srv::GetMode::kType)},
                rtps::encode(ros2::srv::GetMode::Request{})}});
}

ros2::ServiceClient* ComponentClients::routine(const std::string& service,
                                               const std::string& type) {
  std::unique_ptr<ros2::ServiceClient>* place = nullptr;
  {
    const MutexLock lock(mutex_);
    place = &routines_[service];
  }
  return make(*place, service, type, rtps::qos::kServices,
              {{{node_ + "/get_parameters", std::string(ros2::srv::GetParameters::kType)},
                rtps::encode(ros2::srv::GetParameters::Request{})}});
}

ros2::ServiceClient* ComponentClients::parameter_names() {
  const MutexLock lock(mutex_);
  if (!parameter_names_) {
    const ros2::ServiceName name{node_ + "/list_parameters",
                                 std::string(ros2::srv::ListParameters::kType)};
    auto made = ros2::ServiceClient::create(self_, name, rtps::qos::kParameterServices);
    if (!made) return nullptr;
    parameter_names_ = std::move(*made);
    if (holder_) parameter_names_->ask_only(*holder_);
  }
  return parameter_names_.get();
}

}  // namespace culprit::link
