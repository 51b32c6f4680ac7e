#include "link/survey.h"

#include <algorithm>
#include <future>

#include "base/live_clock.h"
#include "ros2/process_finder.h"

namespace culprit::ros2 {
namespace {

constexpr std::size_t kMaxStatuses = 10'000;  // the network decides how many there are
constexpr std::size_t kMaxLoggers = 2'000;    // likewise
constexpr std::size_t kMaxLines = 30;         // of each
constexpr std::size_t kMaxLine = 2'000;       // bytes of a line
constexpr std::size_t kMaxShown = 256;        // bytes, of a status, a logger or a file of code
constexpr std::size_t kMaxStatus = 16 << 10;  // bytes

// In bytes, about.
std::size_t size_of(const msg::DiagnosticStatus& status) {
  std::size_t size = status.name.size() + status.hardware_id.size();
  for (const msg::KeyValue& pair : status.values)
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
    : options_(std::move(options)), tasks_(std::make_unique<TaskGroup>(executor_)) {}

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
  Graph::Options graph;
  graph.listener = [this](const GraphChange& change) { on_change(change); };
  graph.find_process = [finder = ProcessFinder()](const ParticipantInfo& participant) {
    return finder.find(participant);
  };
  auto context = Context::create(executor_, options_.participant, std::move(graph));
  if (!context) return Error{context.error()};
  context_ = std::move(*context);
  auto node = Node::create(*context_, options_.name);
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
  constexpr Qos kQos{.reliability = Reliability::kBestEffort, .depth = 100};
  auto events = node_->create_subscription<msg::ParameterEvent>(
      "/parameter_events", kQos,
      [this](const msg::ParameterEvent& event) { on_parameter_event(event); });
  if (!events) return Error{events.error()};
  parameter_events_ = std::move(*events);
  auto diagnostics = node_->create_subscription<msg::DiagnosticArray>(
      "/diagnostics", kQos,
      [this](const msg::DiagnosticArray& message) { on_diagnostics(message); });
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
    constexpr Qos kQos{.reliability = Reliability::kBestEffort, .depth = 100};
    auto log = node_->create_subscription<msg::Log>("/rosout", kQos,
                                                    [this](const msg::Log& line) { on_log(line); });
    if (log) log_ = std::move(*log);
  });
}

void Survey::on_log(const msg::Log& line) {
  const MutexLock lock(mutex_);
  if (line.name.size() > kMaxShown) return;
  if (log_lines_.size() >= kMaxLoggers && !log_lines_.contains(line.name)) return;
  std::deque<msg::Log>& lines = log_lines_[line.name];
  lines.push_back({.stamp = line.stamp,
                   .level = line.level,
                   .name = line.name,
                   .msg = line.msg.substr(0, kMaxLine),
                   .file = line.file.substr(0, kMaxShown),
                   .function = line.function.substr(0, kMaxShown),
                   .line = line.line});
  if (lines.size() > kMaxLines) lines.pop_front();
}

std::vector<msg::Log> Survey::log_of(const std::string& logger) const {
  std::vector<msg::Log> all;
  const MutexLock lock(mutex_);
  for (const auto& [name, lines] : log_lines_) {
    if (name == logger || name.starts_with(logger + "."))
      all.insert(all.end(), lines.begin(), lines.end());
  }
  std::ranges::stable_sort(
      all, {}, [](const msg::Log& line) { return std::pair(line.stamp.sec, line.stamp.nanosec); });
  if (all.size() > kMaxLines) all.erase(all.begin(), all.end() - kMaxLines);
  return all;
}

MapPicture Survey::map(const std::string& wanted, std::uint64_t known) {
  tasks_->post([this, wanted] { follow_map(wanted); });
  return map_->picture(known, live_now());
}

void Survey::follow_map(const std::string& wanted) {
  std::vector<MapWatch::Topic> published;
  for (const auto& [name, use] : topics_) {
    if (!use.publishers.empty()) published.push_back({name, use.type, use.offered});
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
  tasks_->post_at(Executor::Clock::now() + kMapLease, [this] { end_map_lease(); });
}

LiveInventory Survey::inventory() const {
  LiveInventory all;
  const MutexLock lock(mutex_);
  for (const auto& [node, services] : services_) {
    all.nodes[node];
    for (const auto& [service, endpoint] : services) all.services.emplace(service, endpoint.type);
  }
  for (const auto& [node, reading] : nodes_read_) all.nodes[node] = reading->told();
  for (const auto& [node, pid] : pids_) {
    if (const auto found = all.nodes.find(node); found != all.nodes.end()) found->second.pid = pid;
  }
  for (const auto& [topic, use] : topics_) {
    LiveInventory::Topic& entry = all.topics[topic];
    entry.type = use.type;
    entry.publishers = use.publishers;
    const auto reading = topics_read_.find(topic);
    if (reading != topics_read_.end()) reading->second->tell(entry);
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
      const std::unordered_map<Guid, Rhythm> of_writers = reading->rhythms();
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

Expected<MessageLibrary> Survey::find_service_type(const std::string& service) {
  auto found = std::make_shared<std::promise<Expected<MessageLibrary>>>();
  tasks_->post([this, service, found] {
    for (const auto& [node, services] : services_) {
      const auto offered = services.find(service);
      if (offered == services.end()) continue;
      const GraphEndpoint& endpoint = offered->second;
      return types_->find(
          {node, endpoint.type, endpoint.service_hash, pid_of(node), endpoint.type_hash},
          [found](const Expected<MessageLibrary*>& library) {
            found->set_value(library ? Expected<MessageLibrary>(**library)
                                     : Expected<MessageLibrary>(Error{library.error()}));
          });
    }
    found->set_value(Error{"nobody offers " + service + " any more"});
  });
  return found->get_future().get();
}

int Survey::pid_of(const std::string& node) const {
  const MutexLock lock(mutex_);
  const auto known = pids_.find(node);
  return known == pids_.end() ? 0 : known->second;
}

// ---- the graph

void Survey::on_change(const GraphChange& change) {
  if (const auto* joined = std::get_if<NodeJoined>(&change)) {
    if (joined->node.name == options_.name.full()) return;
    {
      const MutexLock lock(mutex_);
      services_[joined->node.name];
      pids_[joined->node.name] = joined->node.pid;
    }
    read_node(joined->node.name);
  } else if (const auto* left = std::get_if<NodeLeft>(&change)) {
    const MutexLock lock(mutex_);
    services_.erase(left->node);
    pids_.erase(left->node);
    nodes_read_.erase(left->node);
  } else if (const auto* endpoint = std::get_if<EndpointJoined>(&change)) {
    if (endpoint->node != options_.name.full()) on_endpoint(endpoint->node, endpoint->endpoint);
  } else if (const auto* gone = std::get_if<EndpointLeft>(&change)) {
    if (gone->node != options_.name.full()) on_endpoint_left(*gone);
  }
}

void Survey::on_endpoint(const std::string& node, const GraphEndpoint& endpoint) {
  if (endpoint.kind == EndpointKind::kClient) return;
  if (endpoint.kind == EndpointKind::kServer) {
    {
      const MutexLock lock(mutex_);
      services_[node][endpoint.name] = endpoint;
    }
    const auto reading = nodes_read_.find(node);
    if (reading != nodes_read_.end()) reading->second->service_seen(endpoint.name);
    return;
  }
  {
    const MutexLock lock(mutex_);
    TopicUse& use = topics_[endpoint.name];
    const bool publishes = endpoint.kind == EndpointKind::kPublisher;
    if (publishes || use.type.empty()) {
      use.type = endpoint.type;
      use.type_hash = endpoint.type_hash;
    }
    if (publishes) {
      use.publishers.insert(node);
      if (use.offered.durability == Durability::kVolatile) use.offered = endpoint.qos;
    } else {
      ++use.subscribers;
    }
  }
  read_topic(endpoint.name);
}

void Survey::on_endpoint_left(const EndpointLeft& gone) {
  const MutexLock lock(mutex_);
  if (gone.kind == EndpointKind::kServer) {
    const auto node = services_.find(gone.node);
    if (node != services_.end()) node->second.erase(gone.name);
    return;
  }
  const auto topic = topics_.find(gone.name);
  if (gone.kind == EndpointKind::kClient || topic == topics_.end()) return;
  TopicUse& use = topic->second;
  if (gone.kind == EndpointKind::kPublisher) {
    use.publishers.erase(gone.node);
  } else {
    --use.subscribers;
  }
  if (use.publishers.empty()) topics_read_.erase(gone.name);
  if (use.publishers.empty() && use.subscribers == 0) topics_.erase(topic);
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
  for (const auto& [node, services] : services_) read_node(node);
  for (const auto& [topic, fields] : interest_.fields_of_topics) read_topic(topic);
}

void Survey::read_node(const std::string& node) {
  if (!interest_.includes_node(node) || nodes_read_.contains(node)) return;
  auto reading = std::make_unique<NodeReading>(*node_, node);
  for (const auto& [service, endpoint] : services_[node]) reading->service_seen(service);
  const MutexLock lock(mutex_);
  nodes_read_.emplace(node, std::move(reading));
}

void Survey::read_topic(const std::string& topic) {
  const auto wanted = interest_.fields_of_topics.find(topic);
  const auto use = topics_.find(topic);
  const bool can_be_read = use != topics_.end() && !use->second.publishers.empty();
  if (wanted == interest_.fields_of_topics.end() || !can_be_read) return;
  const TopicUse& read = use->second;
  if (const auto reading = topics_read_.find(topic); reading != topics_read_.end())
    return reading->second->publisher_offers(read.offered);
  if (wanted->second.empty()) return read_topic_with(topic, read.type, nullptr);
  const std::string& publisher = *read.publishers.begin();
  types_->find({publisher, read.type, read.type_hash, pid_of(publisher)},
               [this, topic, type = read.type](const Expected<MessageLibrary*>& library) {
                 read_topic_with(topic, type, library);
               });
}

// Much may have changed until a type was found.
void Survey::read_topic_with(const std::string& topic, const std::string& type,
                             const Expected<MessageLibrary*>& library) {
  const auto wanted = interest_.fields_of_topics.find(topic);
  if (wanted == interest_.fields_of_topics.end() || topics_read_.contains(topic)) return;
  auto reading = TopicReading::open(node_->entry(), topic, type, topics_[topic].offered.keys,
                                    wanted->second, library);
  if (!reading) return;
  reading->publisher_offers(topics_[topic].offered);
  const MutexLock lock(mutex_);
  topics_read_.emplace(topic, std::move(reading));
}

void Survey::on_parameter_event(const msg::ParameterEvent& event) {
  const auto reading = nodes_read_.find(event.node);
  if (reading != nodes_read_.end()) reading->second->parameters_changed(event);
}

void Survey::on_diagnostics(const msg::DiagnosticArray& message) {
  const MutexLock lock(mutex_);
  for (const msg::DiagnosticStatus& heard : message.status) {
    const StatusKey key{heard.name, heard.hardware_id};
    if (statuses_.size() >= kMaxStatuses && !statuses_.contains(key)) continue;
    if (heard.name.size() > kMaxShown || size_of(heard) > kMaxStatus) continue;
    LiveInventory::Status& status = statuses_[key];
    status = {heard.name, heard.hardware_id, heard.level, {}};
    StatusCourse& course = courses_[key];
    ++course.messages;
    course.worst = std::max(course.worst, heard.level);
    for (const msg::KeyValue& pair : heard.values) {
      status.values[pair.key] = pair.value;
      if (course.keys.size() < StatusCourse::kMostKeys || course.keys.contains(pair.key))
        course.keys[pair.key].note(value_from_text(pair.value));
    }
  }
}

}  // namespace culprit::ros2
