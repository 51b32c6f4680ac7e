#include "ros2/subscription.h"

namespace culprit::ros2 {

Expected<std::unique_ptr<RawSubscription>> RawSubscription::create(
    NodeEntry& node, std::string_view topic, std::string_view type, const Qos& qos, PayloadUse use,
    SampleCallback on_sample, std::function<void()> on_unheard) {
  const auto name = resolve_name(topic, node.name());
  if (!name) return Error{name.error()};
  if (!is_valid_type_name(type))
    return Error{"'" + printable(type) + "' is not the name of a type"};
  auto reader =
      node.context().participant().create_reader({.topic = mangle_topic(Channel::kTopic, *name),
                                                  .type = mangle_type(Channel::kTopic, type),
                                                  .qos = qos,
                                                  .payload = use,
                                                  .user_data = {},
                                                  .on_match = {},
                                                  .on_unheard = std::move(on_unheard)},
                                                 std::move(on_sample));
  if (!reader) return Error{reader.error()};
  return std::make_unique<RawSubscription>(node, std::move(*reader));
}

RawSubscription::RawSubscription(NodeEntry& node, std::unique_ptr<Reader> reader)
    : node_(node), reader_(std::move(reader)) {
  node_.add(reader_->guid());
}

RawSubscription::~RawSubscription() { node_.remove(reader_->guid()); }

Expected<std::unique_ptr<Subscription>> Subscription::create(NodeEntry& node,
                                                             std::string_view topic,
                                                             std::string_view type, const Qos& qos,
                                                             Callback callback) {
  std::unique_ptr<Subscription> subscription(
      new Subscription(node.context().executor(), qos.depth, std::move(callback)));
  auto raw = RawSubscription::create(
      node, topic, type, qos, PayloadUse::kWhole,
      [s = subscription.get()](const Sample& sample) { s->on_sample(sample); });
  if (!raw) return Error{raw.error()};
  subscription->raw_ = std::move(*raw);
  return subscription;
}

Subscription::Subscription(Executor& executor, std::size_t depth, Callback callback)
    : depth_(depth), callback_(std::move(callback)), tasks_(executor) {}

Subscription::~Subscription() { tasks_.close(); }

void Subscription::on_sample(const Sample& sample) {
  {
    const std::lock_guard lock(mutex_);
    if (payloads_.size() >= depth_) payloads_.pop_front();
    payloads_.emplace_back(sample.payload.begin(), sample.payload.end());
  }
  tasks_.post([this] { deliver_next(); });
}

void Subscription::deliver_next() {
  Bytes payload;
  {
    const std::lock_guard lock(mutex_);
    if (payloads_.empty()) return;
    payload = std::move(payloads_.front());
    payloads_.pop_front();
  }
  callback_(payload);
}

}  // namespace culprit::ros2
