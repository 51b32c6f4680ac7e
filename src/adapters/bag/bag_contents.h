// The contents of a bag as far as it was read: topics, message definitions, and losses.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace culprit::bag {

// One type of messages on one topic. A topic whose type changes within a bag has several.
struct BagTopic {
  std::string name;      // with its leading slash, whether the recorder wrote it or not
  std::string type;      // "sensor_msgs/msg/Image", also where the recorder wrote sensor_msgs/Image
  std::string encoding;  // "cdr"; of any other, only the arrival of messages can be told
  std::string
      offered_qos{};  // YAML, as the recorder wrote it; may be empty, or left out for its size
};

struct BagMessage {
  std::int64_t at = 0;     // nanoseconds since 1970: as recorded, but without jumps of the clock
  std::size_t topic = 0;   // in BagContents::topics()
  std::string_view bytes;  // valid until the next message
  std::int64_t recorded_at = 0;  // as recorded
  // The copy lacks messages between the one before and this one: a part or a chunk is missing or
  // damaged. A silence there says nothing about the robot.
  bool is_after_hole = false;
};

// The clock of the recorder was set, or it recorded nothing for very long.
struct ClockJump {
  std::int64_t at = 0;           // time of the first message after it, as BagMessage::at
  std::int64_t by = 0;           // ns; negative: backward
  std::int64_t recorded_at = 0;  // of that message
};

// The file decides how much there is of all this, so each has an end.
class BagContents {
 public:
  // Its place in topics(): the same for the same name and type.
  std::size_t place_of(BagTopic topic);
  const std::vector<BagTopic>& topics() const { return topics_; }

  // The recorder's definition of a message type (ros2::MessageLibrary::learn). The first one counts, an
  // empty one does not.
  void define(std::string_view type, std::string_view text);
  // Null if the bag has none.
  const std::string* definition_of(const std::string& type) const;

  // A line for people: what cannot be read, where and why.
  void lose(std::string what);
  // The same once for many messages: "12 messages " and `why`.
  void lose_message(const char* why) { ++lost_messages_[why]; }
  std::vector<std::string> losses() const;

  // A line for people that is no loss: a file that is no part of the recording.
  void remark(std::string what);
  const std::vector<std::string>& remarks() const { return remarks_; }

  void note_jump(ClockJump jump);
  const std::vector<ClockJump>& jumps() const { return jumps_; }

 private:
  std::vector<BagTopic> topics_;
  std::size_t qos_bytes_ = 0;
  std::map<std::pair<std::string, std::string>, std::size_t> places_;  // by name and type
  std::unordered_map<std::string, std::string> definitions_;           // by type
  std::size_t definition_bytes_ = 0;
  std::vector<std::string> losses_;
  std::size_t more_losses_ = 0;
  std::unordered_map<std::string_view, std::uint64_t> lost_messages_;
  std::vector<std::string> remarks_;
  std::vector<ClockJump> jumps_;
};

}  // namespace culprit::bag
