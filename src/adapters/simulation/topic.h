// Topics of a simulated robot, with messages of any type, and their users.
//
// A message that is published reaches each subscriber after the topic's latency, or is lost. A
// subscription keeps the last few that its node had no time for, as ROS 2 does.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <utility>

#include "simulation/node.h"

namespace culprit::simulation {

// The delay and the loss of messages on their way.
struct Transport {
  Span latency;
  double loss = 0;  // probability
};

// When a node offers or uses a topic.
enum class Use : std::uint8_t {
  kAlways,      // while its process runs
  kWhileActive  // and its lifecycle is active
};

// The value of `field` in `message`; nothing if it has no such field. Messages whose fields rules
// read have an overload of this in their own namespace.
template <class Message>
std::optional<Value> field_of(const Message& /*message*/, std::string_view /*field*/) {
  return std::nullopt;
}

class TopicBase {
 public:
  // `world` must outlive the topic.
  TopicBase(World& world, std::string name, Transport transport);
  virtual ~TopicBase();
  TopicBase(const TopicBase&) = delete;
  TopicBase& operator=(const TopicBase&) = delete;

  const std::string& name() const { return name_; }
  World& world() const { return world_; }

  Transport transport() const { return transport_; }
  void set_transport(Transport transport) { transport_ = transport; }

  // Whether the world's watchers receive the samples of this topic, and which fields of them.
  void set_watched(bool is_watched) { is_watched_ = is_watched; }
  bool is_watched() const { return is_watched_; }
  void watch_field(const std::string& field);

 protected:
  using Fields = std::vector<std::pair<std::string, Value>>;

  // When a message that leaves at `departure` arrives; nothing if it is lost. Messages to one place
  // do not overtake each other: `last` is when the one before arrived.
  std::optional<Time> arrival(Time departure, Time& last);
  const std::vector<std::string>& watched_fields() const { return fields_; }
  void show(Time departure, Fields fields);  // to the watchers

 private:
  World& world_;
  std::string name_;
  Transport transport_;
  Random random_;
  bool is_watched_ = false;
  std::vector<std::string> fields_;  // that are watched
  Time last_shown_{};
};

// A node's end of a topic. It reports to the watchers when it comes and goes.
class Endpoint {
 public:
  // All must outlive the endpoint.
  Endpoint(Node& node, EndpointKind kind, std::string name, Use use);
  virtual ~Endpoint();
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;

  Node& node() const { return node_; }
  EndpointKind kind() const { return kind_; }
  const std::string& name() const { return name_; }
  bool is_open() const;  // it can send or receive now

  // Reports to the watchers if that changed.
  void report();
  // Drops the messages that wait here.
  virtual void forget() {}

 protected:
  void rename(std::string name);

 private:
  void show(bool is_there) const;

  Node& node_;
  EndpointKind kind_;
  std::string name_;
  Use use_;
  bool is_reported_ = false;
};

template <class Message>
class Subscription;

template <class Message>
class Topic : public TopicBase {
 public:
  explicit Topic(World& world, std::string name, Transport transport = {})
      : TopicBase(world, std::move(name), transport) {}

 private:
  friend class Subscription<Message>;
  template <class>
  friend class Publisher;

  void publish(Time departure, const Message& message) {
    for (Subscription<Message>* reader : readers_) {
      if (const auto at = arrival(departure, reader->last_arrival_))
        world().at(*at, [reader, message] { reader->deliver(message); });
    }
    if (is_watched()) show(departure, fields_of(message));
  }

  Fields fields_of(const Message& message) const {
    Fields fields;
    for (const std::string& field : watched_fields()) {
      if (auto value = field_of(message, field)) fields.emplace_back(field, std::move(*value));
    }
    return fields;
  }

  std::vector<Subscription<Message>*> readers_;
};

template <class Message>
class Publisher : public Endpoint {
 public:
  Publisher(Node& node, Topic<Message>& topic, Use use = Use::kWhileActive)
      : Endpoint(node, EndpointKind::kPublisher, topic.name(), use), topic_(topic) {}

  // While the endpoint is not open, messages are dropped.
  void publish(const Message& message) {
    if (is_open()) topic_.publish(departure(), message);
  }

 private:
  Time departure() const { return node().free_at(); }

  Topic<Message>& topic_;
};

template <class Message>
class Subscription : public Endpoint {
 public:
  using Handler = std::function<void(const Message&)>;
  static constexpr std::size_t kDepth = 10;  // ROS 2's default: keep the last ten

  Subscription(Node& node, Topic<Message>& topic, Handler handler, Use use = Use::kWhileActive)
      : Endpoint(node, EndpointKind::kSubscriber, topic.name(), use),
        topic_(&topic),
        handler_(std::move(handler)) {
    topic_->readers_.push_back(this);
  }
  ~Subscription() override { std::erase(topic_->readers_, this); }

  // From now on it reads this topic.
  void read(Topic<Message>& topic) {
    std::erase(topic_->readers_, this);
    topic_ = &topic;
    topic_->readers_.push_back(this);
    rename(topic.name());
  }

 private:
  friend class Topic<Message>;

  void deliver(const Message& message) {
    if (!is_open()) return;
    kept_.push_back(message);
    if (kept_.size() > kDepth) {
      kept_.pop_front();
    } else {
      node().post([this] { take(); });
    }
  }

  void forget() override { kept_.clear(); }

  void take() {
    if (kept_.empty()) return;
    const Message message = std::move(kept_.front());
    kept_.pop_front();
    if (is_open()) handler_(message);
  }

  Topic<Message>* topic_;
  Handler handler_;
  std::deque<Message> kept_;
  Time last_arrival_{};
};

}  // namespace culprit::simulation
