// A node's publishers: of payloads, or of messages of a known type. Thread-safe.
#pragma once

#include <memory>
#include <string_view>
#include <utility>

#include "base/expected.h"
#include "ros2/context.h"
#include "ros2/participant.h"
#include "rtps/cdr.h"

namespace culprit::ros2 {

class RawPublisher {
 public:
  // `topic` as resolve_name takes it; `type` is "package/msg/Type". The node entry outlives the
  // publisher. `type_hash` is announced (type_description.h), unless it is empty.
  static Expected<std::unique_ptr<RawPublisher>> create(NodeEntry& node, std::string_view topic,
                                                        std::string_view type, const rtps::Qos& qos,
                                                        std::string_view type_hash = {});
  RawPublisher(NodeEntry& node, std::unique_ptr<Writer> writer);
  ~RawPublisher();
  RawPublisher(const RawPublisher&) = delete;
  RawPublisher& operator=(const RawPublisher&) = delete;

  // False when the middleware refused it.
  bool publish(rtps::ByteView payload) { return writer_->write(payload).has_value(); }

 private:
  NodeEntry& node_;
  std::unique_ptr<Writer> writer_;
};

template <class Message>
class Publisher {
 public:
  explicit Publisher(std::unique_ptr<RawPublisher> raw) : raw_(std::move(raw)) {}

  bool publish(const Message& message) { return raw_->publish(rtps::encode(message)); }

 private:
  std::unique_ptr<RawPublisher> raw_;
};

}  // namespace culprit::ros2
