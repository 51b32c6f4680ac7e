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

namespace culprit::link {

// All members may be called from any thread. The clients that they give live as long as this; null: it cannot be made,
// which is reported (LinkTrouble).
class ComponentClients {
 public:
  // `self` is our own node, `node` the component's full name. All references must outlive it.
  ComponentClients(ros2::NodeEntry& self, std::string node, const ComponentNeeds& needs,
                   Inbox& inbox);

  // From now on only the answers of this participant count; those of modes have a holder of their own.
  void ask_only(const rtps::GuidPrefix& participant);
  void modes_come_from(const rtps::GuidPrefix& participant);

  // Whether a client of its lifecycle was made.
  bool has_lifecycle();

  ros2::ServiceClient* lifecycle();
  ros2::ServiceClient* lifecycle_reader();
  ros2::ServiceClient* parameters();
  ros2::ServiceClient* parameter_reader();
  // Null is not reported: a secured domain need not allow it.
  ros2::ServiceClient* parameter_names();
  ros2::ServiceClient* modes();
  ros2::ServiceClient* routine(const std::string& service, const std::string& type);

 private:
  ros2::ServiceClient* make(std::unique_ptr<ros2::ServiceClient>& client,
                            const std::string& service, std::string_view type, const rtps::Qos& qos,
                            std::optional<ros2::ServiceClient::Probe> probe = {});
  // Makes a client that only reads.
  ros2::ServiceClient* make_reader(std::unique_ptr<ros2::ServiceClient>& client,
                                   const std::string& service, std::string_view type,
                                   const rtps::Qos& qos);
  ros2::ServiceClient* keep(std::unique_ptr<ros2::ServiceClient>& client,
                            const std::string& service,
                            Expected<std::unique_ptr<ros2::ServiceClient>> made)
      CULPRIT_REQUIRES(mutex_);

  ros2::NodeEntry& self_;
  const std::string node_;
  const ComponentNeeds& needs_;
  Inbox& inbox_;

  Mutex mutex_;  // never held while calling
  std::optional<rtps::GuidPrefix> mode_holder_ CULPRIT_GUARDED_BY(mutex_);
  std::optional<rtps::GuidPrefix> holder_ CULPRIT_GUARDED_BY(mutex_);  // whose answers count
  // The clients are made with it, by make(), and stay.
  std::unique_ptr<ros2::ServiceClient> lifecycle_;
  std::unique_ptr<ros2::ServiceClient> lifecycle_reader_;  // where the rules only look
  std::unique_ptr<ros2::ServiceClient> parameters_;
  std::unique_ptr<ros2::ServiceClient> parameter_reader_;  // likewise
  std::unique_ptr<ros2::ServiceClient> parameter_names_;   // if one was missing
  std::unique_ptr<ros2::ServiceClient> modes_;
  std::map<std::string, std::unique_ptr<ros2::ServiceClient>> routines_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace culprit::link
