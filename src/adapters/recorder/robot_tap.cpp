#include "recorder/robot_tap.h"

#include <atomic>
#include <unistd.h>

#include "base/live_clock.h"
#include "recorder/graph_json.h"
#include "ros2/process_finder.h"

namespace culprit::recorder {
namespace {

// Its topic is transient local, but its last line is no state of the robot.
constexpr std::string_view kLog = "/rosout";

// As people and other recorders write it: "std_msgs/Header", not "std_msgs/msg/Header".
std::string as_ros2msg(std::string text) {
  constexpr std::string_view kLong = "/msg/";
  for (std::size_t at = text.find(kLong); at != std::string::npos; at = text.find(kLong, at))
    text.replace(at, kLong.size(), "/");
  return text;
}

RecordedTopic described(const std::string& topic, const ros2::Graph::Publishers& publishers,
                        std::optional<std::string> definition) {
  const ros2::GraphEndpoint& first = *publishers.begin()->second;
  RecordedTopic about{topic, first.type, first.type_hash, std::move(definition), {}};
  for (const auto& [node, endpoint] : publishers) about.offers.push_back(endpoint->qos);
  return about;
}

std::int64_t nanoseconds_of(rtps::SystemTime time) { return time.time_since_epoch().count(); }

}  // namespace

// One topic that is received. Its callback runs on receive threads, one at a time.
class RobotTap::Listening {
 public:
  Listening(RobotTap& tap, std::string topic, std::size_t number, bool may_be_given_up)
      : tap_(tap), topic_(std::move(topic)), number_(number), may_be_given_up_(may_be_given_up) {}

  Expected<void> open(ros2::NodeEntry& self, const std::string& type, rtps::Keys keys) {
    auto listener = link::TopicListener::open(
        self, topic_, type, keys, ros2::PayloadUse::kWholeLater,
        {.on_arrival =
             [this](const ros2::Sample& sample) {
               if (sample.size > kSmall) want_to_hurry();
             },
         .on_message = [this](const ros2::Sample& sample) { take(sample); },
         .on_unheard = [this] { want_to_hurry(); }});
    if (!listener) return Error{listener.error()};
    listener_ = std::move(*listener);
    return {};
  }

  void publisher_offers(const rtps::Qos& offered) {
    // If there can be no second reader, the topic is received once only.
    (void)listener_->publisher_offers(offered);
    if (offered.durability == rtps::Durability::kTransientLocal && topic_ != kLog)
      is_latched_ = true;
  }

  Expected<void> hurry() { return listener_->hurry(); }

 private:
  void want_to_hurry() {
    if (!hurries_.exchange(true))
      tap_.tasks_->post([&tap = tap_, topic = topic_] { tap.hurry(topic); });
  }

  void take(const ros2::Sample& sample) {
    if (sample.payload.size() > kLarge) is_large_ = true;
    if (is_large_ && may_be_given_up_ && is_too_much(sample.payload.size())) return;
    RingMessage message{.topic = number_,
                        .sequence = static_cast<std::uint32_t>(sample.identity.sequence),
                        .received = nanoseconds_of(sample.received),
                        .sent = nanoseconds_of(sample.sent),
                        .payload = {sample.payload.begin(), sample.payload.end()}};
    const Share share = is_large_ ? Share::kLarge : Share::kSmall;
    if (!is_latched_) return tap_.recorder_.take(std::move(message), share);
    tap_.recorder_.take_latched(std::move(message), sample.identity.writer, share);
  }

  // Over a while; the first message comes at once.
  bool is_too_much(std::size_t bytes) {
    constexpr Duration kWhile = std::chrono::seconds(2);
    const Time now = live_now();
    if (measured_since_ == kNever) measured_since_ = now;
    const Duration took = now - measured_since_;
    const double per_second = static_cast<double>(measured_) / seconds(std::max(took, kWhile));
    measured_ += bytes;
    const bool is_too_much =
        per_second * seconds(tap_.options_.before) > static_cast<double>(tap_.options_.large_bytes);
    if (!is_too_much) {
      if (took > kWhile) {
        measured_since_ = now;
        measured_ = 0;
      }
      return false;
    }
    if (!is_given_up_)
      tap_.tasks_->post(
          [&tap = tap_, topic = topic_, per_second] { tap.give_up(topic, per_second); });
    is_given_up_ = true;
    return true;
  }

  RobotTap& tap_;
  const std::string topic_;
  const std::size_t number_;  // in the recorder
  const bool may_be_given_up_;
  std::atomic<bool> is_latched_ = false;
  std::atomic<bool> hurries_ = false;
  bool is_large_ = false;
  bool is_given_up_ = false;
  Time measured_since_ = kNever;
  std::uint64_t measured_ = 0;                     // bytes
  std::unique_ptr<link::TopicListener> listener_;  // last: its callbacks use the others
};

Expected<std::unique_ptr<RobotTap>> RobotTap::open(Options options, IncidentRecorder& recorder) {
  std::unique_ptr<RobotTap> tap(new RobotTap(std::move(options), recorder));
  if (const auto started = tap->start(); !started) return Error{started.error()};
  return tap;
}

RobotTap::RobotTap(Options options, IncidentRecorder& recorder)
    : options_(std::move(options)),
      recorder_(recorder),
      tasks_(std::make_unique<ros2::TaskGroup>(executor_)) {}

RobotTap::~RobotTap() {
  executor_.stop();
  if (thread_.joinable()) thread_.join();
  // Clients and readers go before the node that they belong to, and all that post before the tasks.
  topics_.clear();
  types_.reset();
  node_.reset();
  context_.reset();
  tasks_.reset();
}

Expected<void> RobotTap::start() {
  ros2::Graph::Options graph;
  graph.listener = [this](const ros2::GraphChange& change) { on_change(change); };
  graph.find_process = [finder = ros2::ProcessFinder()](const ros2::ParticipantInfo& participant) {
    return finder.find(participant);
  };
  auto context = ros2::Context::create(executor_, options_.participant, std::move(graph));
  if (!context) return Error{context.error()};
  context_ = std::move(*context);
  auto node = ros2::Node::create(*context_, {"/", "_culprit_recorder_" + std::to_string(getpid())});
  if (!node) return Error{node.error()};
  node_ = std::move(*node);
  types_ = std::make_unique<link::TypeFinder>(*node_, options_.types);
  thread_ = std::thread([this] { executor_.run(); });
  return {};
}

void RobotTap::on_change(const ros2::GraphChange& change) {
  if (std::holds_alternative<ros2::GraphTrouble>(change)) return;
  if (const auto* endpoint = std::get_if<ros2::EndpointJoined>(&change)) {
    if (node_ != nullptr && endpoint->node == node_->name().full()) return;
    on_endpoint(endpoint->endpoint);
  } else if (const auto* gone = std::get_if<ros2::EndpointLeft>(&change)) {
    on_endpoint_left(*gone);
  }
  graph_changed();
}

void RobotTap::on_endpoint(const ros2::GraphEndpoint& endpoint) {
  if (endpoint.kind != EndpointKind::kPublisher || !options_.topics.includes(endpoint.name)) return;
  if (topics_.size() >= kMostHeard && !topics_.contains(endpoint.name)) {
    if (!std::exchange(are_too_many_, true))
      options_.say("only " + std::to_string(kMostHeard) +
                   " topics are recorded at a time; choose with --record-topics");
    return;
  }
  hear(endpoint.name);
}

void RobotTap::on_endpoint_left(const ros2::EndpointLeft& gone) {
  const auto topic = topics_.find(gone.name);
  if (gone.kind != EndpointKind::kPublisher || topic == topics_.end()) return;
  if (!publishers_of(gone.name).empty()) return;
  TopicUse& use = topic->second;
  use.listening.reset();
  if (!use.is_given_up && !use.is_asked_for) topics_.erase(topic);
}

// But for ourselves.
ros2::Graph::Publishers RobotTap::publishers_of(const std::string& topic) const {
  ros2::Graph::Publishers publishers = context_->graph().nodes_publishing(topic);
  publishers.erase(node_->name().full());
  return publishers;
}

void RobotTap::hear(const std::string& topic) {
  TopicUse& use = topics_[topic];
  const ros2::Graph::Publishers publishers = publishers_of(topic);
  if (use.is_given_up || use.is_asked_for || publishers.empty()) return;
  if (use.listening != nullptr) {
    for (const auto& [node, endpoint] : publishers) use.listening->publisher_offers(endpoint->qos);
    return;
  }
  const auto& [node, endpoint] = *publishers.begin();
  const std::string type = endpoint->type;
  const std::string hash = endpoint->type_hash;
  use.is_asked_for = true;
  types_->find({node, type, hash, context_->graph().process_of(node)},
               [this, topic, type, hash](const Expected<ros2::MessageLibrary*>& library) {
                 hear_with(topic, type, hash, library);
               });
}

// Much may have changed until a type was found.
void RobotTap::hear_with(const std::string& topic, const std::string& type, const std::string& hash,
                         const Expected<ros2::MessageLibrary*>& library) {
  TopicUse& use = topics_[topic];
  use.is_asked_for = false;
  const ros2::Graph::Publishers publishers = publishers_of(topic);
  if (publishers.empty()) {
    topics_.erase(topic);
    return;
  }
  const ros2::GraphEndpoint& publisher = *publishers.begin()->second;
  if (publisher.type != type || publisher.type_hash != hash) return hear(topic);
  std::optional<std::string> definition;
  std::string why = library ? "" : library.error();
  if (library) {
    const auto parts = (*library)->with_parts(type);
    if (parts) {
      definition = as_ros2msg(ros2::to_text(type, *parts));
    } else {
      why = parts.error();
    }
  }
  if (!definition && unknown_types_.insert(type).second)
    options_.say("recorded without its definition, so that others cannot read it: " + why);
  const std::size_t number =
      recorder_.add_topic(described(topic, publishers, std::move(definition)));
  auto listening = std::make_unique<Listening>(*this, topic, number, !options_.topics.names(topic));
  if (const auto opened = listening->open(node_->entry(), type, publisher.qos.keys); !opened) {
    use.is_given_up = true;
    return options_.say(topic + " is not recorded: " + opened.error());
  }
  use.listening = std::move(listening);
  for (const auto& [node, endpoint] : publishers) use.listening->publisher_offers(endpoint->qos);
}

// If it cannot be, it goes on as it was.
void RobotTap::hurry(const std::string& topic) {
  const auto found = topics_.find(topic);
  if (found != topics_.end() && found->second.listening != nullptr)
    (void)found->second.listening->hurry();
}

void RobotTap::give_up(const std::string& topic, double bytes_per_second) {
  const auto found = topics_.find(topic);
  if (found == topics_.end()) return;
  found->second.listening.reset();
  found->second.is_given_up = true;
  options_.say(
      topic + " is not recorded: " + std::to_string(static_cast<long>(bytes_per_second / 1e6)) +
      " MB/s are more than the memory for large messages holds; name it with --record-topics "
      "to have what fits of it, or give more with --record-budget");
}

// Once for all that changes within a moment: a robot that starts changes it a thousand times.
void RobotTap::graph_changed() {
  constexpr auto kMoment = std::chrono::seconds(1);
  if (std::exchange(is_graph_due_, true)) return;
  tasks_->post_at(ros2::Executor::Clock::now() + kMoment, [this] { tell_graph(); });
}

void RobotTap::tell_graph() {
  is_graph_due_ = false;
  recorder_.note_graph(graph_to_json(context_->graph()));
}

}  // namespace culprit::recorder
