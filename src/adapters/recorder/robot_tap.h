// Receives the topics of a live ROS 2 robot for a recorder, as a hidden node in a DDS participant
// of its own: no message is handled on a thread of the manager.
//
// Readers are best effort and hold no writer back; a latched topic has a second one, which receives
// the earlier messages (link/topic_listener.h). The definition of a type is found as for rules
// (link/type_finder.h), before its topic is received. If it is found nowhere, its messages are kept
// all the same, and that is reported once.
//
// A topic whose messages are small has time: its messages are taken together every few hundredths
// of a second. Waking a thread for each message would be most of the cost of recording it. A
// message of more than kSmall bytes, or one that cannot be put together, ends that for its topic.
//
// A message of more than kLarge bytes makes its topic a large one, which is kept in memory of its
// own. If that memory cannot hold such a topic for the recorded time, and nobody named the topic,
// it is no longer received, and that is reported once.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>

#include "link/topic_listener.h"
#include "link/type_finder.h"
#include "recorder/incident_recorder.h"
#include "recorder/topic_choice.h"
#include "ros2/node.h"

namespace culprit::recorder {

class RobotTap {
 public:
  static constexpr std::size_t kSmall = 16 * 1024;  // bytes
  static constexpr std::size_t kLarge = 64 * 1024;
  // The most topics at a time: each costs memory, and the network decides how many there are.
  static constexpr std::size_t kMostHeard = 2000;

  struct Options {
    ros2::ParticipantOptions participant;
    link::TypeFinder::Options types{};
    TopicChoice topics{{}};
    Duration before{};            // that is recorded
    std::size_t large_bytes = 0;  // of memory for large messages
    // Receives messages for people. Called from any thread of the tap.
    std::function<void(const std::string&)> say = [](const std::string&) {};
  };

  // `recorder` must outlive the tap. Errors: the domain cannot be joined.
  static Expected<std::unique_ptr<RobotTap>> open(Options options, IncidentRecorder& recorder);
  ~RobotTap();
  RobotTap(const RobotTap&) = delete;

 private:
  class Listening;

  struct TopicUse {
    std::unique_ptr<Listening> listening;  // null: not received
    bool is_asked_for = false;             // its type is
    bool is_given_up = false;              // it is too large
  };

  RobotTap(Options options, IncidentRecorder& recorder);
  Expected<void> start();

  // On the executor's thread.
  void on_change(const ros2::GraphChange& change);
  void on_endpoint(const ros2::GraphEndpoint& endpoint);
  void on_endpoint_left(const ros2::EndpointLeft& gone);
  ros2::Graph::Publishers publishers_of(const std::string& topic) const;
  void hear(const std::string& topic);
  void hear_with(const std::string& topic, const std::string& type, const std::string& hash,
                 const Expected<ros2::MessageLibrary*>& library);
  void hurry(const std::string& topic);
  void give_up(const std::string& topic, double bytes_per_second);
  void graph_changed();
  void tell_graph();

  const Options options_;
  IncidentRecorder& recorder_;
  std::map<std::string, TopicUse> topics_;
  std::set<std::string> unknown_types_;  // that were reported
  bool is_graph_due_ = false;
  bool are_too_many_ = false;  // topics, and that was reported

  ros2::Executor executor_;
  std::unique_ptr<ros2::TaskGroup> tasks_;
  std::unique_ptr<ros2::Context> context_;
  std::unique_ptr<ros2::Node> node_;
  std::unique_ptr<link::TypeFinder> types_;
  std::thread thread_;
};

}  // namespace culprit::recorder
