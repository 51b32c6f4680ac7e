// Watches one topic for the rules: its rhythm, and the values of its fields.
//
// If the rules read no field, payloads are not even copied (topic_listener.h).
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/mutex.h"
#include "base/time.h"
#include "inbox/inbox.h"
#include "language/rule_set.h"
#include "link/topic_listener.h"
#include "ros2/field_reader.h"
#include "ros2/sample_gaps.h"

namespace culprit::link {

class TopicWatch {
 public:
  // All references must outlive the watch.
  // `topic` is the first of its name; those of single publishers (FROM) are watched with it.
  TopicWatch(ros2::NodeEntry& self, TopicId topic, const RuleSet& rules, Inbox& inbox);

  // Which component has made each writer of the topic.
  using Writers = std::unordered_map<rtps::Guid, ComponentId>;
  // `ask` is called when a message of an unknown writer arrives that may matter: on any thread, at
  // most once a second. To be called before a publisher is discovered.
  void asks_for_writers(std::function<void()> ask) { ask_for_writers_ = std::move(ask); }
  // From any thread.
  void knows_writers(Writers writers);
  // Whether a message waits for its writer to be known. From any thread.
  bool waits_for_writers() const;

  // Whether it takes a message's type to watch it, not only that it comes.
  bool reads_fields() const;

  TopicId topic() const { return topic_; }
  // Whether it would be known if something came. On the thread of publisher_seen().
  bool is_listening() const { return listener_ != nullptr && counts_; }
  // Whether anything came. From any thread.
  bool has_heard() const { return has_heard_; }

  // A publisher of the topic was discovered: subscribes with its type, unless that is done already.
  // `offered`: its quality of service. `library`: a library with that type; not used where no field
  // is read. On one thread.
  void publisher_seen(const std::string& type, const rtps::Qos& offered,
                      const Expected<ros2::MessageLibrary*>& library);

 private:
  struct Field {
    SignalId signal;
    ros2::FieldReader reader;
    std::optional<ComponentId> publisher;  // FROM
    std::optional<Value> last;
  };
  bool compile_fields(const std::string& type, const Expected<ros2::MessageLibrary*>& library);
  Expected<void> listen(const std::string& type, rtps::Keys keys, ros2::PayloadUse use);
  void tell_once(std::string trouble);
  void on_message(const ros2::Sample& sample);
  void keep(const ros2::Sample& sample) CULPRIT_REQUIRES(mutex_);
  void read(Field& field, rtps::ByteView payload) CULPRIT_REQUIRES(mutex_);
  void on_arrival(const ros2::Sample& sample);
  std::optional<ComponentId> publisher_of(const rtps::Guid& writer);
  void ask();
  void on_unheard();

  ros2::NodeEntry& self_;
  const TopicId topic_;
  const RuleSet& rules_;
  Inbox& inbox_;
  struct OfPublisher {
    TopicId topic;
    ComponentId publisher;
  };
  std::optional<TopicId> whole_;            // from any publisher
  std::vector<OfPublisher> of_publishers_;  // FROM
  bool counts_ = false;                     // the rules read the rhythm of any of them
  bool reads_goals_ = false;                // it is the status of an action
  std::function<void()> ask_for_writers_;
  std::string type_;
  std::set<std::string> told_;  // troubles: each publisher has the same ones

  // Used by the receive thread only, once the listener exists.
  ros2::SampleGaps gaps_;

  mutable Mutex mutex_;
  Time asked_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;  // for writers
  std::vector<Field> fields_ CULPRIT_GUARDED_BY(mutex_);
  Writers writers_ CULPRIT_GUARDED_BY(mutex_);
  // The newest message of each writer that is not known yet: a latched one comes once. The oldest is
  // dropped if there are too many.
  static constexpr std::size_t kMostWaiting = 16;
  static constexpr std::size_t kLargestWaiting = std::size_t{1} << 20;  // bytes
  std::deque<std::pair<rtps::Guid, rtps::Bytes>> waiting_ CULPRIT_GUARDED_BY(mutex_);

  std::atomic<bool> has_heard_ = false;
  std::atomic<bool> told_unheard_ =
      false;  // receive threads come one at a time, but not always one

  std::unique_ptr<TopicListener> listener_;
};

}  // namespace culprit::link
