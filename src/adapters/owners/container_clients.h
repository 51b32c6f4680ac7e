// The services of component containers (composition_interfaces), called over DDS.
//
// Anybody on the network can offer services of these names, and answer. So an answer counts only if
// it comes from the participant that the operating system proves to be the container's process
// (ros2/process_finder.h); an answer from any other participant is reported as a refusal. A request
// to load or to unload is sent once, and not before the container has proven that it knows us
// (ros2/service_client.h).
#pragma once

#include <functional>
#include <map>
#include <memory>

#include "base/mutex.h"
#include "owners/container_services.h"
#include "ros2/node.h"
#include "ros2/service_client.h"

namespace culprit::owners {

// Thread-safe.
class ContainerClients : public ContainerServices {
 public:
  // By full name; nothing: it is one node's.
  using Contest = std::function<std::optional<std::string>(const std::string& node)>;

  // `self` is our own node and outlives this.
  ContainerClients(ros2::NodeEntry& self, Contest contest);
  ~ContainerClients() override;

  ContainerAnswer list(const std::string& container, int pid, Duration patience) override;
  ContainerAnswer load(const Component& component, int pid, Duration patience) override;
  ContainerAnswer unload(const std::string& container, int pid, std::uint64_t id,
                         Duration patience) override;
  Expected<void> could_load(const Component& component, int pid) const override;
  std::optional<std::string> contest(const std::string& container) const override {
    return contest_(container);
  }
  void interrupt() override;

 private:
  enum class Which : std::uint8_t { kList, kLoad, kUnload };
  struct Call {
    std::optional<ros2::CallOutcome> outcome{};
    rtps::Bytes reply{};
    int process = 0;  // that answered; 0: not proven
  };

  Expected<ros2::ServiceClient*> client(const std::string& container, Which which);
  // The payload of the reply, or why there is none.
  std::variant<rtps::Bytes, ContainerAnswer> call(const std::string& container, Which which,
                                                  int pid, rtps::Bytes request, Duration patience);

  ros2::NodeEntry& self_;
  const Contest contest_;
  Mutex mutex_;  // also guards each Call
  ConditionVariable something_came_;
  bool is_ending_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::map<std::pair<std::string, Which>, std::unique_ptr<ros2::ServiceClient>> clients_
      CULPRIT_GUARDED_BY(mutex_);
  ros2::TaskGroup tasks_;
};

}  // namespace culprit::owners
