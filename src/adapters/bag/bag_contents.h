// What a bag turns out to hold while it is read: topics, message definitions, and what was lost.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace culprit::bag {

struct BagTopic {
  std::string name;
  std::string type;      // "sensor_msgs/msg/Image"
  std::string encoding;  // "cdr"; of any other, only the arrival of messages can be told
};

struct BagMessage {
  std::int64_t at = 0;     // nanoseconds since 1970, as recorded
  std::size_t topic = 0;   // in BagContents::topics()
  std::string_view bytes;  // valid until the next message
};

// The file decides how much there is of all this, so each has an end.
class BagContents {
 public:
  // Its place in topics(): the same for the same name.
  std::size_t place_of(BagTopic topic);
  const std::vector<BagTopic>& topics() const { return topics_; }

  // What a message type looked like to the recorder (ros2::MessageLibrary::learn). The first one
  // counts.
  void define(std::string_view type, std::string_view text);
  // Nothing if the bag does not say.
  const std::string* definition_of(const std::string& type) const;

  // A line for people: what cannot be read, where and why.
  void lose(std::string what);
  // The same once for many messages: "12 messages " and `why`.
  void lose_message(const char* why) { ++lost_messages_[why]; }
  std::vector<std::string> losses() const;

 private:
  std::vector<BagTopic> topics_;
  std::unordered_map<std::string, std::size_t> places_;
  std::unordered_map<std::string, std::string> definitions_;  // by type
  std::size_t definition_bytes_ = 0;
  std::vector<std::string> losses_;
  std::size_t more_losses_ = 0;
  std::unordered_map<std::string_view, std::uint64_t> lost_messages_;
};

// One file of a bag, however it is stored.
class Storage {
 public:
  virtual ~Storage() = default;
  // False at the end. What cannot be read is told to the contents and left out.
  virtual bool next(BagMessage& message) = 0;
};

}  // namespace culprit::bag
