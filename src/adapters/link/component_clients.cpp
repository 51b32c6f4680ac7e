#include "link/component_clients.h"

#include <utility>

#include "ros2/services.h"

namespace culprit::ros2 {

ComponentClients::ComponentClients(NodeEntry& self, std::string node, const ComponentNeeds& needs,
                                   Inbox& inbox)
    : self_(self), node_(std::move(node)), needs_(needs), inbox_(inbox) {}

void ComponentClients::ask_only(const GuidPrefix& participant) {
  const MutexLock lock(mutex_);
  holder_ = participant;
  for (const auto* client :
       {&lifecycle_, &lifecycle_reader_, &parameters_, &parameter_reader_, &parameter_names_})
    if (*client) (*client)->ask_only(participant);
  for (const auto& [name, client] : routines_)
    if (client) client->ask_only(participant);
}

void ComponentClients::modes_come_from(const GuidPrefix& participant) {
  const MutexLock lock(mutex_);
  mode_holder_ = participant;
  if (modes_) modes_->ask_only(participant);
}

bool ComponentClients::has_lifecycle() {
  const MutexLock lock(mutex_);
  return lifecycle_ || lifecycle_reader_;
}

ServiceClient* ComponentClients::make(std::unique_ptr<ServiceClient>& client,
                                      const std::string& service, std::string_view type,
                                      const Qos& qos, std::optional<ServiceClient::Probe> probe) {
  const MutexLock lock(mutex_);
  if (client) return client.get();
  const ServiceName name{service, std::string(type)};
  return keep(client, service,
              probe ? ServiceClient::create(self_, name, qos, std::move(*probe))
                    : ServiceClient::create(self_, name, qos));
}

ServiceClient* ComponentClients::make_reader(std::unique_ptr<ServiceClient>& client,
                                             const std::string& service, std::string_view type,
                                             const Qos& qos) {
  const MutexLock lock(mutex_);
  if (client) return client.get();
  return keep(client, service,
              ServiceClient::create(self_, {service, std::string(type)}, qos, Haste::kSoon));
}

ServiceClient* ComponentClients::keep(std::unique_ptr<ServiceClient>& client,
                                      const std::string& service,
                                      Expected<std::unique_ptr<ServiceClient>> made) {
  if (!made) {
    inbox_.put(LinkTrouble{"cannot call " + service + ": " + made.error()});
    return nullptr;
  }
  client = std::move(*made);
  const auto& holder = &client == &modes_ ? mode_holder_ : holder_;
  if (holder) client->ask_only(*holder);
  return client.get();
}

ServiceClient* ComponentClients::lifecycle() {
  return make(lifecycle_, node_ + "/change_state", srv::ChangeState::kType, qos::kServices,
              {{{node_ + "/get_state", std::string(srv::GetState::kType)},
                encode(srv::GetState::Request{})}});
}

ServiceClient* ComponentClients::lifecycle_reader() {
  if (!needs_.changes_lifecycle)
    return make_reader(lifecycle_reader_, node_ + "/get_state", srv::GetState::kType,
                       qos::kServices);
  ServiceClient* client = lifecycle();
  return client == nullptr ? nullptr : client->probe();
}

ServiceClient* ComponentClients::parameters() {
  return make(parameters_, node_ + "/set_parameters", srv::SetParameters::kType,
              qos::kParameterServices,
              {{{node_ + "/get_parameters", std::string(srv::GetParameters::kType)},
                encode(srv::GetParameters::Request{})}});
}

ServiceClient* ComponentClients::parameter_reader() {
  if (!needs_.sets_parameters)
    return make_reader(parameter_reader_, node_ + "/get_parameters", srv::GetParameters::kType,
                       qos::kParameterServices);
  ServiceClient* client = parameters();
  return client == nullptr ? nullptr : client->probe();
}

ServiceClient* ComponentClients::modes() {
  return make(
      modes_, node_ + "/change_mode", srv::ChangeMode::kType, qos::kServices,
      {{{node_ + "/get_mode", std::string(srv::GetMode::kType)}, encode(srv::GetMode::Request{})}});
}

ServiceClient* ComponentClients::routine(const std::string& service, const std::string& type) {
  std::unique_ptr<ServiceClient>* place = nullptr;
  {
    const MutexLock lock(mutex_);
    place = &routines_[service];
  }
  return make(*place, service, type, qos::kServices,
              {{{node_ + "/get_parameters", std::string(srv::GetParameters::kType)},
                encode(srv::GetParameters::Request{})}});
}

ServiceClient* ComponentClients::parameter_names() {
  const MutexLock lock(mutex_);
  if (!parameter_names_) {
    const ServiceName name{node_ + "/list_parameters", std::string(srv::ListParameters::kType)};
    auto made = ServiceClient::create(self_, name, qos::kParameterServices);
    if (!made) return nullptr;
    parameter_names_ = std::move(*made);
    if (holder_) parameter_names_->ask_only(*holder_);
  }
  return parameter_names_.get();
}

}  // namespace culprit::ros2
