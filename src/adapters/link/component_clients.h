// The clients of one component's node: of its lifecycle, its parameters, its modes, its routines.
//
// Each is made at the first use, and kept: a client that the server knows already needs no discovery when every
// millisecond counts. Each service that changes something has a read of the same node as its probe
// (service_client.h). So a request is neither lost to discovery nor sent twice. If the rules only
// look at a node, its client only reads, so a secured domain need not allow more (rights.h).
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/mutex.h"
#include "inbox/inbox.h"
#include "link/component_needs.h"
#include "ros2/service_client.h"

namespace culprit::ros2 {

// All members may be called from any thread. The clients that they give live as long as this; null: it cannot be made,
// which is reported (LinkTrouble).
class ComponentClients {
 public:
  // `self` is our own node, `node` the component's full name. All references must outlive it.
  ComponentClients(NodeEntry& self, std::string node, const ComponentNeeds& needs, Inbox& inbox);

  // From now on only the answers of this participant count; those of modes have a holder of their own.
  void ask_only(const GuidPrefix& participant);
  void modes_come_from(const GuidPrefix& participant);

  // Whether a client of its lifecycle was made.
  bool has_lifecycle();

  ServiceClient* lifecycle();
  ServiceClient* lifecycle_reader();
  ServiceClient* parameters();
  ServiceClient* parameter_reader();
  // Null is not reported: a secured domain need not allow it.
  ServiceClient* parameter_names();
  ServiceClient* modes();
  ServiceClient* routine(const std::string& service, const std::string& type);

 private:
  ServiceClient* make(std::unique_ptr<ServiceClient>& client, const std::string& service,
                      std::string_view type, const Qos& qos,
                      std::optional<ServiceClient::Probe> probe = {});
  // Makes a client that only reads.
  ServiceClient* make_reader(std::unique_ptr<ServiceClient>& client, const std::string& service,
                             std::string_view type, const Qos& qos);
  ServiceClient* keep(std::unique_ptr<ServiceClient>& client, const std::string& service,
                      Expected<std::unique_ptr<ServiceClient>> made) CULPRIT_REQUIRES(mutex_);

  NodeEntry& self_;
  const std::string node_;
  const ComponentNeeds& needs_;
  Inbox& inbox_;

  Mutex mutex_;  // never held while calling
  std::optional<GuidPrefix> mode_holder_ CULPRIT_GUARDED_BY(mutex_);
  std::optional<GuidPrefix> holder_ CULPRIT_GUARDED_BY(mutex_);  // whose answers count
  // The clients are made with it, by make(), and stay.
  std::unique_ptr<ServiceClient> lifecycle_;
  std::unique_ptr<ServiceClient> lifecycle_reader_;  // where the rules only look
  std::unique_ptr<ServiceClient> parameters_;
  std::unique_ptr<ServiceClient> parameter_reader_;  // likewise
  std::unique_ptr<ServiceClient> parameter_names_;   // if one was missing
  std::unique_ptr<ServiceClient> modes_;
  std::map<std::string, std::unique_ptr<ServiceClient>> routines_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace culprit::ros2
