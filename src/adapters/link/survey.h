// A snapshot of a robot, for checks and editors: its graph, its diagnostics, and on request also
// parameters, lifecycle states, and the rates and fields of topics.
//
// It joins as a hidden node, as tools do. It does no harm: readers are best effort, and it reads
// only what was asked for.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "language/live_inventory.h"
#include "link/course.h"
#include "link/map_watch.h"
#include "link/node_reading.h"
#include "link/rhythm.h"
#include "link/topic_reading.h"
#include "link/type_finder.h"
#include "ros2/node.h"

namespace culprit::link {

// ask_for() and inventory() may be called from any thread.
class Survey {
 public:
  struct Options {
    ros2::ParticipantOptions participant;
    ros2::NodeName name{"/", "_culprit_survey"};
    TypeFinder::Options types{};
  };

  // Errors: the domain cannot be joined.
  static Expected<std::unique_ptr<Survey>> open(Options options);
  ~Survey();

  // Replaces the former request.
  void ask_for(LiveInterest interest);

  // The present snapshot. Waits for the executor's thread, so it must not be called there.
  LiveInventory inventory() const;
  // Subscribes to /rosout from now on.
  void listen_to_log();
  // The last lines that loggers of this name, and of names below it, wrote since then; the newest last.
  std::vector<ros2::msg::Log> log_of(const std::string& logger) const;
  // The content of a map view (map_watch.h), with the cells unless their number is `known`. `wanted`: the topic of the map; empty:
  // the usual one. It subscribes to it at the first call, which finds nothing, and no longer if nobody calls for kMapLease.
  MapPicture map(const std::string& wanted, std::uint64_t known);
  static constexpr Duration kMapLease = std::chrono::seconds(5);
  // How the messages came of the topics that were asked for, since they are.
  std::map<std::string, Rhythm> rhythms() const;
  // The same of each node that publishes the topic with one writer; by topic and node. It waits, too.
  std::map<std::string, std::map<std::string, Rhythm>> rhythms_of_publishers() const;

  // The courses of the requested fields of a topic, since the request; by topic and field.
  std::map<std::string, std::map<std::string, ValueCourse>> fields() const;
  // How each diagnostic status went; by name and hardware id.
  using StatusKey = std::pair<std::string, std::string>;
  std::map<StatusKey, StatusCourse> statuses() const;

  // Returns a library with both messages of an existing service; its node may be asked for them.
  // Waits for that, TypeFinder::kPatience at most. Not on the executor's thread.
  Expected<ros2::MessageLibrary> find_service_type(const std::string& service);

 private:
  // The publishers of others on a topic.
  struct Offer {
    std::string publisher;  // the first node
    std::string type;       // of that one
    std::string type_hash;
    rtps::Qos qos;  // of one of them; of one that latches, if there is one
  };

  explicit Survey(Options options);
  Expected<void> start();
  Expected<void> listen();

  // On the executor's thread.
  void on_change(const ros2::GraphChange& change);
  void on_endpoint(const std::string& node, const ros2::GraphEndpoint& endpoint);
  void on_endpoint_left(const ros2::EndpointLeft& gone);
  std::vector<ros2::Graph::NodeView> other_nodes() const;
  std::optional<Offer> offer_of(const std::string& topic) const;
  LiveInventory seen() const;
  void on_parameter_event(const ros2::msg::ParameterEvent& event);
  void on_diagnostics(const ros2::msg::DiagnosticArray& message);
  void on_log(const ros2::msg::Log& line);
  void on_interest(LiveInterest interest);
  void follow_map(const std::string& wanted);
  void end_map_lease();
  void read_node(const std::string& node, const std::vector<ros2::GraphEndpoint>& endpoints);
  void read_topic(const std::string& topic);
  void read_topic_with(const std::string& topic, const std::string& type,
                       const Expected<ros2::MessageLibrary*>& library);

  const Options options_;
  LiveInterest interest_;  // of the executor's thread

  ros2::Executor executor_;
  std::unique_ptr<ros2::Context> context_;
  std::unique_ptr<ros2::Node> node_;
  std::unique_ptr<ros2::Subscription> parameter_events_;
  std::unique_ptr<ros2::Subscription> diagnostics_;
  std::unique_ptr<ros2::Subscription> log_;
  std::unique_ptr<TypeFinder> types_;
  std::unique_ptr<MapWatch> map_;
  Time map_asked_ = kLongAgo;  // of the executor's thread; kLongAgo: nobody looks

  // Guards what follows.
  mutable Mutex mutex_;
  std::map<StatusKey, LiveInventory::Status> statuses_ CULPRIT_GUARDED_BY(mutex_);
  std::map<StatusKey, StatusCourse> courses_ CULPRIT_GUARDED_BY(mutex_);
  std::map<std::string, std::deque<ros2::msg::Log>> log_lines_
      CULPRIT_GUARDED_BY(mutex_);  // by logger
  // The executor's thread changes these two with the mutex, and reads them without; others read with
  // it.
  std::map<std::string, std::unique_ptr<NodeReading>> nodes_read_;
  std::map<std::string, std::unique_ptr<TopicReading>> topics_read_;

  std::unique_ptr<ros2::TaskGroup> tasks_;
  std::thread thread_;
};

}  // namespace culprit::link
