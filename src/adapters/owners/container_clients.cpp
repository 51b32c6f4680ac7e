#include "owners/container_clients.h"

#include "base/units.h"
#include "owners/parameter_file.h"
#include "owners/plugin_index.h"
#include "ros2/names.h"
#include "ros2/services.h"

namespace culprit::owners {
namespace {

using namespace ros2;

std::string service_of_container(const std::string& container, const char* name) {
  return container + "/_container/" + name;
}

// A name of a node, or what is safe to show in its place.
std::string node_name(const std::string& said) {
  return is_valid_topic_name(said) ? said : printable(said);
}

// As many as anybody loads.
constexpr std::size_t kMostLoaded = 1000;

}  // namespace

ContainerClients::ContainerClients(NodeEntry& self, Contest contest)
    : self_(self), contest_(std::move(contest)), tasks_(self.context().executor()) {}

ContainerClients::~ContainerClients() {
  interrupt();
  tasks_.close();
  clients_.clear();
}

void ContainerClients::interrupt() {
  {
    const MutexLock lock(mutex_);
    is_ending_ = true;
  }
  something_came_.notify_all();
}

Expected<ServiceClient*> ContainerClients::client(const std::string& container, Which which) {
  const MutexLock lock(mutex_);
  auto& client = clients_[{container, which}];
  if (client) return client.get();
  const ServiceName list{service_of_container(container, "list_nodes"),
                         std::string(srv::ListNodes::kType)};
  const ServiceName name = which == Which::kList ? list
                           : which == Which::kLoad
                               ? ServiceName{service_of_container(container, "load_node"),
                                             std::string(srv::LoadNode::kType)}
                               : ServiceName{service_of_container(container, "unload_node"),
                                             std::string(srv::UnloadNode::kType)};
  auto made = which == Which::kList
                  ? ServiceClient::create(self_, name, rtps::qos::kServices)
                  : ServiceClient::create(self_, name, rtps::qos::kServices,
                                          {{list}, rtps::encode(srv::ListNodes::Request{})});
  if (!made) return Error{"cannot call " + name.name + ": " + made.error()};
  client = std::move(*made);
  return client.get();
}

std::variant<rtps::Bytes, ContainerAnswer> ContainerClients::call(const std::string& container,
                                                                  Which which, int pid,
                                                                  rtps::Bytes request,
                                                                  Duration patience) {
  constexpr Duration kProof = std::chrono::seconds(1);
  const auto to = client(container, which);
  if (!to) return ContainerAnswer{Outcome::kUnreachable, to.error()};
  const auto under_way = std::make_shared<Call>();
  (*to)->call(std::move(request), which == Which::kList ? Repeat::kUntilAnswered : Repeat::kNever,
              patience, [this, under_way](const CallResult& result) {
                under_way->reply.assign(result.reply.begin(), result.reply.end());
                // The graph knows which process the answer is from; it is asked on its own thread.
                tasks_.post([this, under_way, outcome = result.outcome, server = result.server] {
                  const MutexLock lock(mutex_);
                  under_way->outcome = outcome;
                  under_way->process = self_.context().graph().process_of(server);
                  something_came_.notify_all();
                });
              });
  MutexLock lock(mutex_);
  something_came_.wait_for(lock, patience + kProof, [&]() CULPRIT_REQUIRES(mutex_) {
    return is_ending_ || under_way->outcome;
  });
  if (!under_way->outcome || *under_way->outcome == CallOutcome::kTimedOut)
    return ContainerAnswer{Outcome::kTimedOut,
                           container + " did not answer within " + culprit::to_string(patience)};
  if (*under_way->outcome == CallOutcome::kUnreachable)
    return ContainerAnswer{Outcome::kUnreachable,
                           container + " offers no container services that answer"};
  if (under_way->process != pid)
    return ContainerAnswer{Outcome::kRefused,
                           "another process answers for the container " + container +
                               ", and is not believed: it is not proven to be process " +
                               std::to_string(pid)};
  return std::move(under_way->reply);
}

ContainerAnswer ContainerClients::list(const std::string& container, int pid, Duration patience) {
  auto reply =
      call(container, Which::kList, pid, rtps::encode(srv::ListNodes::Request{}), patience);
  if (auto* none = std::get_if<ContainerAnswer>(&reply)) return std::move(*none);
  const auto response = rtps::decode<srv::ListNodes::Response>(std::get<rtps::Bytes>(reply));
  if (!response || response->full_node_names.size() != response->unique_ids.size() ||
      response->unique_ids.size() > kMostLoaded)
    return {Outcome::kRefused, container + " answered the list of nodes in a wrong form"};
  ContainerAnswer answer;
  for (std::size_t i = 0; i < response->unique_ids.size(); ++i)
    answer.nodes.push_back({node_name(response->full_node_names[i]), response->unique_ids[i]});
  return answer;
}

ContainerAnswer ContainerClients::load(const Component& component, int pid, Duration patience) {
  const Composition& how = *component.composed;
  const auto name = parse_node_name(component.node);
  if (!name) return {Outcome::kRefused, name.error()};
  srv::LoadNode::Request request;
  request.package_name = how.package;
  request.plugin_name = how.plugin;
  request.node_name = name->name;
  request.node_namespace = name->name_space;
  request.remap_rules = how.remaps;
  if (!how.parameters.empty()) {
    auto parameters = read_parameter_file(how.parameters, component.node);
    if (!parameters) return {Outcome::kRefused, parameters.error()};
    request.parameters = std::move(*parameters);
  }
  auto reply = call(how.container, Which::kLoad, pid, rtps::encode(request), patience);
  if (auto* none = std::get_if<ContainerAnswer>(&reply)) return std::move(*none);
  const auto response = rtps::decode<srv::LoadNode::Response>(std::get<rtps::Bytes>(reply));
  if (!response) return {Outcome::kRefused, how.container + " answered the load in a wrong form"};
  if (!response->success)
    return {Outcome::kRefused, how.container + " did not load " + how.plugin + " of " +
                                   how.package + ": " + printable(response->error_message)};
  return {Outcome::kDone, "", {{node_name(response->full_node_name), response->unique_id}}};
}

ContainerAnswer ContainerClients::unload(const std::string& container, int pid, std::uint64_t id,
                                         Duration patience) {
  auto reply =
      call(container, Which::kUnload, pid, rtps::encode(srv::UnloadNode::Request{id}), patience);
  if (auto* none = std::get_if<ContainerAnswer>(&reply)) return std::move(*none);
  const auto response = rtps::decode<srv::UnloadNode::Response>(std::get<rtps::Bytes>(reply));
  if (!response) return {Outcome::kRefused, container + " answered the unload in a wrong form"};
  if (!response->success) return {Outcome::kRefused, printable(response->error_message)};
  return {};
}

Expected<void> ContainerClients::could_load(const Component& component, int pid) const {
  const Composition& how = *component.composed;
  if (const auto found = find_plugin(pid, how.package, how.plugin); !found)
    return Error{found.error()};
  if (how.parameters.empty()) return {};
  const auto read = read_parameter_file(how.parameters, component.node);
  return read ? Expected<void>() : Expected<void>(Error{read.error()});
}

}  // namespace culprit::owners
