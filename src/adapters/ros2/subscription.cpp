#include "ros2/subscription.h"

#include <algorithm>

#include "base/live_clock.h"

namespace culprit::ros2 {

Expected<std::unique_ptr<RawSubscription>> RawSubscription::create(
    NodeEntry& node, std::string_view topic, std::string_view type, const rtps::Qos& qos,
    PayloadUse use, SampleCallback on_sample, std::function<void()> on_unheard) {
  const auto name = resolve_name(topic, node.name());
  if (!name) return Error{name.error()};
  if (!is_valid_type_name(type))
    return Error{"'" + printable(type) + "' is not the name of a type"};
  std::unique_ptr<RawSubscription> subscription(
      new RawSubscription(node,
                          {.topic = mangle_topic(Channel::kTopic, *name),
                           .type = mangle_type(Channel::kTopic, type),
                           .qos = qos,
                           .payload = use,
                           .user_data = {},
                           .on_match = {},
                           .on_unheard = std::move(on_unheard)},
                          std::move(on_sample)));
  if (auto opened = subscription->open(); !opened) return Error{opened.error()};
  return subscription;
}

RawSubscription::RawSubscription(NodeEntry& node, ReaderOptions options, SampleCallback on_sample)
    : node_(node),
      options_(std::move(options)),
      on_sample_(std::move(on_sample)),
      tell_unheard_(std::exchange(options_.on_unheard, [this] { on_unheard(); })),
      tasks_(node.context().executor()) {
  // A reliable one waits for what it lacks, and is sent it again.
  if (options_.qos.reliability == rtps::Reliability::kReliable) options_.on_unheard = {};
}

RawSubscription::~RawSubscription() {
  tasks_.close();
  close();
}

Expected<void> RawSubscription::open() {
  auto reader = node_.context().participant().create_reader(options_, on_sample_);
  if (!reader) return Error{reader.error()};
  reader_ = std::move(*reader);
  node_.add(reader_->guid());
  return {};
}

void RawSubscription::close() {
  if (reader_) node_.remove(reader_->guid());
  reader_.reset();
}

void RawSubscription::on_unheard() {
  if (tell_unheard_) tell_unheard_();
  const Time now = live_now();
  if (now < next_) return;
  // It went well for a while: this is something new.
  if (now > later(next_, pause_)) pause_ = kSoonest;
  next_ = later(now, pause_);
  pause_ = std::min(2 * pause_, kLatest);
  tasks_.post([this] { make_anew(); });
}

void RawSubscription::make_anew() {
  constexpr auto kAgain = std::chrono::seconds(1);
  close();
  if (!open()) tasks_.post_at(Executor::Clock::now() + kAgain, [this] { make_anew(); });
}

Expected<std::unique_ptr<Subscription>> Subscription::create(NodeEntry& node,
                                                             std::string_view topic,
                                                             std::string_view type,
                                                             const rtps::Qos& qos,
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
    const MutexLock lock(mutex_);
    const auto is_full = [&]() CULPRIT_REQUIRES(mutex_) {
      return payloads_.size() >= depth_ || bytes_ + sample.payload.size() > kMostBytes;
    };
    while (!payloads_.empty() && is_full()) take_oldest();
    payloads_.emplace_back(sample.payload.begin(), sample.payload.end());
    bytes_ += sample.payload.size();
  }
  tasks_.post([this] { deliver_next(); });
}

rtps::Bytes Subscription::take_oldest() {
  rtps::Bytes oldest = std::move(payloads_.front());
  payloads_.pop_front();
  bytes_ -= oldest.size();
  return oldest;
}

void Subscription::deliver_next() {
  rtps::Bytes payload;
  {
    const MutexLock lock(mutex_);
    if (payloads_.empty()) return;
    payload = take_oldest();
  }
  callback_(payload);
}

}  // namespace culprit::ros2
