#include "link/survey.h"

#include <algorithm>
#include <future>

#include "base/live_clock.h"
#include "ros2/process_finder.h"

namespace culprit::link {
namespace {

constexpr std::size_t kMaxStatuses = 10'000;  // the network decides how many there are
constexpr std::size_t kMaxLoggers = 2'000;    // likewise
constexpr std::size_t kMaxLines = 30;         // of each
constexpr std::size_t kMaxLine = 2'000;       // bytes of a line
constexpr std::size_t kMaxShown = 256;        // bytes, of a status, a logger or a file of code
constexpr std::size_t kMaxStatus = 16 << 10;  // bytes

// In bytes, about.
std::size_t size_of(const ros2::msg::DiagnosticStatus& status) {
  std::size_t size = status.name.size() + status.hardware_id.size();
  for (const ros2::msg::KeyValue& pair : status.values)
    size += sizeof pair + pair.key.size() + pair.value.size();
  return size;
}

}  // namespace

Expected<std::unique_ptr<Survey>> Survey::open(Options options) {
  std::unique_ptr<Survey> survey(new Survey(std::move(options)));
  if (auto started = survey->start(); !started) return Error{started.error()};
  return survey;
}

Survey::Survey(Options options)
    : options_(std::move(options)), tasks_(std::make_unique<ros2::TaskGroup>(executor_)) {}

Survey::~Survey() {
  executor_.stop();
  if (thread_.joinable()) thread_.join();
  // Clients and readers go before the node that they belong to.
  tasks_.reset();
  topics_read_.clear();
  nodes_read_.clear();
  map_.reset();
  log_.reset();
  diagnostics_.reset();
  parameter_events_.reset();
  types_.reset();
  node_.reset();
  context_.reset();
}

Expected<void> Survey::start() {
  ros2::Graph::Options graph;
  graph.listener = [this](const ros2::GraphChange& change) { on_change(change); };
  graph.find_process = [finder = ros2::ProcessFinder()](const ros2::ParticipantInfo& participant) {
    return finder.find(participant);
  };
  auto context = ros2::Context::create(executor_, options_.participant, std::move(graph));
  if (!context) return Error{context.error()};
  context_ = std::move(*context);
  auto node = ros2::Node::create(*context_, options_.name);
  if (!node) return Error{node.error()};
  node_ = std::move(*node);
  types_ = std::make_unique<TypeFinder>(*node_, options_.types);
  map_ = std::make_unique<MapWatch>(node_->entry());
  if (auto listening = listen(); !listening) return listening;
  thread_ = std::thread([this] { executor_.run(); });
  return {};
}

Expected<void> Survey::listen() {
  // Best effort and deep: many nodes announce at once when a robot starts.
  constexpr rtps::Qos kQos{.reliability = rtps::Reliability::kBestEffort, .depth = 100};
  auto events = node_->create_subscription<ros2::msg::ParameterEvent>(
      "/parameter_events", kQos,
      [this](const ros2::msg::ParameterEvent& event) { on_parameter_event(event); });
  if (!events) return Error{events.error()};
  parameter_events_ = std::move(*events);
  auto diagnostics = node_->create_subscription<ros2::msg::DiagnosticArray>(
      "/diagnostics", kQos,
      [this](const ros2::msg::DiagnosticArray& message) { on_diagnostics(message); });
  if (!diagnostics) return Error{diagnostics.error()};
  diagnostics_ = std::move(*diagnostics);
  return {};
}

void Survey::ask_for(LiveInterest interest) {
  tasks_->post([this, interest = std::move(interest)] { on_interest(interest); });
}

void Survey::listen_to_log() {
  tasks_->post([this] {
    if (log_) return;
    // Best effort: a reader that dawdles must not hold a node back that logs.
    constexpr rtps::Qos kQos{.reliability = rtps::Reliability::kBestEffort, .depth = 100};
    auto log = node_->create_subscription<ros2::msg::Log>(
        "/rosout", kQos, [this](const ros2::msg::Log& line) { on_log(line); });
    if (log) log_ = std::move(*log);
  });
}

void Survey::on_log(const ros2::msg::Log& line) {
  const MutexLock lock(mutex_);
  if (line.name.size() > kMaxShown) return;
  if (log_lines_.size() >= kMaxLoggers && !log_lines_.contains(line.name)) return;
  std::deque<ros2::msg::Log>& lines = log_lines_[line.name];
  lines.push_back({.stamp = line.stamp,
                   .level = line.level,
                   .name = line.name,
                   .msg = line.msg.substr(0, kMaxLine),
                   .file = line.file.substr(0, kMaxShown),
                   .function = line.function.substr(0, kMaxShown),
                   .line = line.line});
  if (lines.size() > kMaxLines) lines.pop_front();
}

std::vector<ros2::msg::Log> Survey::log_of(const std::string& logger) const {
  std::vector<ros2::msg::Log> all;
  const MutexLock lock(mutex_);
  for (const auto& [name, lines] : log_lines_) {
    if (name == logger || name.starts_with(logger + "."))
      all.insert(all.end(), lines.begin(), lines.end());
  }
  std::ranges::stable_sort(all, {}, [](const ros2::msg::Log& line) {
    return std::pair(line.stamp.sec, line.stamp.nanosec);
  });
  if (all.size() > kMaxLines) all.erase(all.begin(), all.end() - kMaxLines);
  return all;
}

MapPicture Survey::map(const std::string& wanted, std::uint64_t known) {
  tasks_->post([this, wanted] { follow_map(wanted); });
  return map_->picture(known, live_now());
}

void Survey::follow_map(const std::string& wanted) {
  std::vector<MapWatch::Topic> published;
  for (const auto& [name, publishers] : context_->graph().published()) {
    if (const auto offer = offer_of(name)) published.push_back({name, offer->type, offer->qos});
  }
  map_->follow(published, wanted);
  const bool is_first = map_asked_ == kLongAgo;
  map_asked_ = live_now();
  if (is_first) end_map_lease();
}

void Survey::end_map_lease() {
  if (live_now() >= later(map_asked_, kMapLease)) {
    map_->stop();
    map_asked_ = kLongAgo;
    return;
  }
  tasks_->post_at(ros2::Executor::Clock::now() + kMapLease, [this] { end_map_lease(); });
}

LiveInventory Survey::inventory() const {
  auto found = std::make_shared<std::promise<LiveInventory>>();
  tasks_->post([this, found] { found->set_value(seen()); });
  return found->get_future().get();
}

LiveInventory Survey::seen() const {
  LiveInventory all;
  const MutexLock lock(mutex_);
  for (const ros2::Graph::NodeView& view : other_nodes()) {
    LiveInventory::Node& node = all.nodes[view.node.name];
    const auto reading = nodes_read_.find(view.node.name);
    if (reading != nodes_read_.end()) node = reading->second->told();
    node.pid = view.node.pid;
    for (const ros2::GraphEndpoint& endpoint : view.endpoints) {
      const bool publishes = endpoint.kind == EndpointKind::kPublisher;
      if (endpoint.kind == EndpointKind::kServer)
        all.services.emplace(endpoint.name, endpoint.type);
      if (!publishes && endpoint.kind != EndpointKind::kSubscriber) continue;
      LiveInventory::Topic& topic = all.topics[endpoint.name];
      if (topic.type.empty() || (publishes && !topic.is_published())) topic.type = endpoint.type;
      if (publishes) topic.publishers.insert(view.node.name);
    }
  }
  for (const auto& [name, reading] : topics_read_) {
    if (const auto topic = all.topics.find(name); topic != all.topics.end())
      reading->tell(topic->second);
  }
  for (const auto& [key, status] : statuses_) all.diagnostics.push_back(status);
  return all;
}

std::map<std::string, Rhythm> Survey::rhythms() const {
  std::map<std::string, Rhythm> all;
  const MutexLock lock(mutex_);
  for (const auto& [topic, reading] : topics_read_) all[topic] = reading->rhythm();
  return all;
}

std::map<std::string, std::map<std::string, Rhythm>> Survey::rhythms_of_publishers() const {
  using All = std::map<std::string, std::map<std::string, Rhythm>>;
  auto found = std::make_shared<std::promise<All>>();
  tasks_->post([this, found] {
    All all;
    const MutexLock lock(mutex_);
    for (const auto& [topic, reading] : topics_read_) {
      const std::unordered_map<rtps::Guid, Rhythm> of_writers = reading->rhythms();
      std::map<std::string, int> writers;
      for (const auto& [writer, node] : context_->graph().publishers_of(topic)) {
        const auto rhythm = of_writers.find(writer);
        if (rhythm != of_writers.end()) all[topic][node] = rhythm->second;
        if (++writers[node] > 1) all[topic].erase(node);
      }
    }
    found->set_value(std::move(all));
  });
  return found->get_future().get();
}

std::map<std::string, std::map<std::string, ValueCourse>> Survey::fields() const {
  std::map<std::string, std::map<std::string, ValueCourse>> all;
  const MutexLock lock(mutex_);
  for (const auto& [topic, reading] : topics_read_) all[topic] = reading->courses();
  return all;
}

std::map<Survey::StatusKey, StatusCourse> Survey::statuses() const {
  const MutexLock lock(mutex_);
  return courses_;
}

Expected<ros2::MessageLibrary> Survey::find_service_type(const std::string& service) {
  auto found = std::make_shared<std::promise<Expected<ros2::MessageLibrary>>>();
  tasks_->post([this, service, found] {
    for (const ros2::Graph::NodeView& view : other_nodes()) {
      const auto offered =
          std::ranges::find_if(view.endpoints, [&](const ros2::GraphEndpoint& each) {
            return each.kind == EndpointKind::kServer && each.name == service;
          });
      if (offered == view.endpoints.end()) continue;
      return types_->find(
          {view.node.name, offered->type, offered->service_hash, view.node.pid, offered->type_hash},
          [found](const Expected<ros2::MessageLibrary*>& library) {
            found->set_value(library ? Expected<ros2::MessageLibrary>(**library)
                                     : Expected<ros2::MessageLibrary>(Error{library.error()}));
          });
    }
    found->set_value(Error{"no node offers " + service + " any more"});
  });
  return found->get_future().get();
}

// ---- the graph

void Survey::on_change(const ros2::GraphChange& change) {
  if (const auto* joined = std::get_if<ros2::NodeJoined>(&change)) {
    // Its endpoints come next.
    if (joined->node.name != options_.name.full()) read_node(joined->node.name, {});
  } else if (const auto* left = std::get_if<ros2::NodeLeft>(&change)) {
    const MutexLock lock(mutex_);
    nodes_read_.erase(left->node);
  } else if (const auto* endpoint = std::get_if<ros2::EndpointJoined>(&change)) {
    if (endpoint->node != options_.name.full()) on_endpoint(endpoint->node, endpoint->endpoint);
  } else if (const auto* gone = std::get_if<ros2::EndpointLeft>(&change)) {
    on_endpoint_left(*gone);
  }
}

void Survey::on_endpoint(const std::string& node, const ros2::GraphEndpoint& endpoint) {
  if (endpoint.kind == EndpointKind::kPublisher) return read_topic(endpoint.name);
  const auto reading = nodes_read_.find(node);
  if (endpoint.kind == EndpointKind::kServer && reading != nodes_read_.end())
    reading->second->service_seen(endpoint.name);
}

void Survey::on_endpoint_left(const ros2::EndpointLeft& gone) {
  if (gone.kind != EndpointKind::kPublisher || offer_of(gone.name)) return;
  const MutexLock lock(mutex_);
  topics_read_.erase(gone.name);
}

std::vector<ros2::Graph::NodeView> Survey::other_nodes() const {
  std::vector<ros2::Graph::NodeView> views = context_->graph().nodes();
  std::erase_if(views, [&](const auto& view) { return view.node.name == options_.name.full(); });
  return views;
}

std::optional<Survey::Offer> Survey::offer_of(const std::string& topic) const {
  std::optional<Offer> offer;
  for (const auto& [node, endpoint] : context_->graph().nodes_publishing(topic)) {
    if (node == options_.name.full()) continue;
    if (!offer) offer = Offer{node, endpoint->type, endpoint->type_hash, endpoint->qos};
    if (offer->qos.durability == rtps::Durability::kVolatile) offer->qos = endpoint->qos;
  }
  return offer;
}

// ---- what was asked for

void Survey::on_interest(LiveInterest interest) {
  const LiveInterest before = std::exchange(interest_, std::move(interest));
  {
    const MutexLock lock(mutex_);
    std::erase_if(nodes_read_, [&](const auto& n) { return !interest_.includes_node(n.first); });
    std::erase_if(topics_read_, [&](const auto& t) {
      const auto wanted = interest_.fields_of_topics.find(t.first);
      return wanted == interest_.fields_of_topics.end() ||
             wanted->second != before.fields_of_topics.at(t.first);
    });
  }
  for (const ros2::Graph::NodeView& view : other_nodes()) read_node(view.node.name, view.endpoints);
  for (const auto& [topic, fields] : interest_.fields_of_topics) read_topic(topic);
}

void Survey::read_node(const std::string& node, const std::vector<ros2::GraphEndpoint>& endpoints) {
  if (!interest_.includes_node(node) || nodes_read_.contains(node)) return;
  auto reading = std::make_unique<NodeReading>(*node_, node);
  for (const ros2::GraphEndpoint& endpoint : endpoints) {
    if (endpoint.kind == EndpointKind::kServer) reading->service_seen(endpoint.name);
  }
  const MutexLock lock(mutex_);
  nodes_read_.emplace(node, std::move(reading));
}

void Survey::read_topic(const std::string& topic) {
  const auto wanted = interest_.fields_of_topics.find(topic);
  if (wanted == interest_.fields_of_topics.end()) return;
  const std::optional<Offer> offer = offer_of(topic);
  if (!offer) return;
  if (const auto reading = topics_read_.find(topic); reading != topics_read_.end())
    return reading->second->publisher_offers(offer->qos);
  if (wanted->second.empty()) return read_topic_with(topic, offer->type, nullptr);
  types_->find({offer->publisher, offer->type, offer->type_hash,
                context_->graph().process_of(offer->publisher)},
               [this, topic, type = offer->type](const Expected<ros2::MessageLibrary*>& library) {
                 read_topic_with(topic, type, library);
               });
}

// Much may have changed until a type was found.
void Survey::read_topic_with(const std::string& topic, const std::string& type,
                             const Expected<ros2::MessageLibrary*>& library) {
  const auto wanted = interest_.fields_of_topics.find(topic);
  const std::optional<Offer> offer = offer_of(topic);
  if (wanted == interest_.fields_of_topics.end() || topics_read_.contains(topic) || !offer) return;
  auto reading =
      TopicReading::open(node_->entry(), topic, type, offer->qos.keys, wanted->second, library);
  if (!reading) return;
  reading->publisher_offers(offer->qos);
  const MutexLock lock(mutex_);
  topics_read_.emplace(topic, std::move(reading));
}

void Survey::on_parameter_event(const ros2::msg::ParameterEvent& event) {
  const auto reading = nodes_read_.find(event.node);
  if (reading != nodes_read_.end()) reading->second->parameters_changed(event);
}

void Survey::on_diagnostics(const ros2::msg::DiagnosticArray& message) {
  const MutexLock lock(mutex_);
  for (const ros2::msg::DiagnosticStatus& heard : message.status) {
    const StatusKey key{heard.name, heard.hardware_id};
    if (statuses_.size() >= kMaxStatuses && !statuses_.contains(key)) continue;
    if (heard.name.size() > kMaxShown || size_of(heard) > kMaxStatus) continue;
    LiveInventory::Status& status = statuses_[key];
    status = {heard.name, heard.hardware_id, heard.level, {}};
    StatusCourse& course = courses_[key];
    ++course.messages;
    course.worst = std::max(course.worst, heard.level);
    for (const ros2::msg::KeyValue& pair : heard.values) {
      status.values[pair.key] = pair.value;
      if (course.keys.size() < StatusCourse::kMostKeys || course.keys.contains(pair.key))
        course.keys[pair.key].note(value_from_text(pair.value));
    }
  }
}

}  // namespace culprit::link
