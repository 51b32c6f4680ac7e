// Listens to one topic: its rate now, and the last values of some of its fields.
//
// Without fields no payload is copied (topic_listener.h).
#pragma once

#include <deque>
#include <memory>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/mutex.h"
#include "base/time.h"
#include "language/live_inventory.h"
#include "link/course.h"
#include "link/rhythm.h"
#include "link/topic_listener.h"
#include "ros2/field_reader.h"

namespace culprit::link {

class TopicReading {
 public:
  // Rates are counted over this time.
  static constexpr Duration kWindow = std::chrono::seconds(2);

  // `self` outlives the reading; `library` has the type, or the reason why it is not known. Fields
  // that cannot be read are reported. Returns null if the topic cannot be read with this type.
  static std::unique_ptr<TopicReading> open(ros2::NodeEntry& self, const std::string& topic,
                                            const std::string& type, rtps::Keys keys,
                                            const std::set<std::string>& fields,
                                            const Expected<ros2::MessageLibrary*>& library);

  // A publisher offers this; the earlier messages of a latched topic are read, too.
  void publisher_offers(const rtps::Qos& offered);

  // Enters rate and fields. From any thread.
  void tell(LiveInventory::Topic& topic) const;

  // The rhythm of all messages since it was opened. From any thread.
  Rhythm rhythm() const;
  // The same of each writer.
  std::unordered_map<rtps::Guid, Rhythm> rhythms() const;
  // The courses of its fields, as above.
  std::map<std::string, ValueCourse> courses() const;

 private:
  struct Field {
    std::string path;
    ros2::FieldReader reader;
  };

  struct Arrivals {
    Rhythm rhythm;
    Time last{};
  };

  TopicReading() = default;
  static void note(Arrivals& arrivals, Time now);
  void on_arrival(const ros2::Sample& sample);
  void on_message(const ros2::Sample& sample);

  std::vector<Field> readers_;
  std::map<std::string, std::string> unreadable_;  // fields, with the reason
  Time since_{};
  mutable Mutex mutex_;
  std::deque<Time> arrivals_ CULPRIT_GUARDED_BY(mutex_);
  Arrivals all_ CULPRIT_GUARDED_BY(mutex_);
  std::unordered_map<rtps::Guid, Arrivals> of_writers_ CULPRIT_GUARDED_BY(mutex_);
  std::map<std::string, Value> values_ CULPRIT_GUARDED_BY(mutex_);
  std::map<std::string, ValueCourse> courses_ CULPRIT_GUARDED_BY(mutex_);
  std::unique_ptr<TopicListener> listener_;
};

}  // namespace culprit::link
