// Our readers and writers of a participant that goes through a helper program, and the frames that the helper is sent
// for them.
//
// They outlive each helper: the next one is asked for all of them again. A sample goes to one helper once, and never to
// its successor.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/mutex.h"
#include "culprit_link/protocol.h"
#include "ros2/helper_endpoint.h"
#include "ros2/helper_outbox.h"

namespace culprit::ros2 {

// All members may be called from any thread. After each that queues a frame, wake the thread that sends.
class HelperEndpoints {
 public:
  using Ptr = std::shared_ptr<HelperEndpoint>;

  explicit HelperEndpoints(const rtps::GuidPrefix& prefix) : prefix_(prefix) {}

  // `kind`: as the last byte of DDS's entity ids has it.
  rtps::Guid guid(std::uint32_t id, std::uint8_t kind) const;

  // Errors: it is no topic of ROS 2.
  Expected<Ptr> add(rtps::EndpointRole role, const std::string& topic, const std::string& type,
                    const rtps::Qos& qos, PayloadUse use, SampleCallback on_sample,
                    MatchCallback on_match);
  void remove(const HelperEndpoint& ours);
  // Gives the number of the sample. Nothing: no helper takes it now.
  std::optional<std::int64_t> write(const HelperEndpoint& ours, rtps::ByteView payload,
                                    const rtps::SampleIdentity& related);

  Ptr find(std::uint32_t id);  // null: it was removed
  std::vector<Ptr> all();
  std::vector<Ptr> readers_of(HelperEndpoint::Purpose purpose, const std::string& name);

  // As HelperOutbox; begin() asks the new helper for all of them.
  void greet(const culprit_link::Frame& first);
  void begin();
  void close();
  void queue(const culprit_link::Frame& frame);
  bool send(int socket);
  bool has_waiting();
  bool is_stuck();

 private:
  const rtps::GuidPrefix prefix_;

  Mutex mutex_;
  HelperOutbox outbox_ CULPRIT_GUARDED_BY(mutex_);
  std::map<std::uint32_t, Ptr> ours_ CULPRIT_GUARDED_BY(mutex_);  // by id
  std::uint32_t last_id_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::int64_t last_number_ CULPRIT_GUARDED_BY(mutex_) = 0;
};

}  // namespace culprit::ros2
