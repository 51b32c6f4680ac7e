// The contents of a recording, topic by topic, without any rule.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bag/bag_contents.h"
#include "ros2/field_reader.h"
#include "ros2/message_library.h"

namespace culprit::bag {

struct TopicInfo {
  std::string name;
  std::string type;
  std::string encoding;
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  std::int64_t first = 0;  // as BagMessage::at; of no meaning without messages
  std::int64_t last = 0;
  // The longest time without a message, from the beginning of the recording to its end, but for holes
  // of the copy. It begins at `gap_at`.
  std::int64_t longest_gap = 0;
  std::int64_t gap_at = 0;
  std::int64_t gap_clock = 0;  // as recorded
  // Why messages cannot be decoded: the type is not known, or their bytes do not fit it. Empty: they can.
  std::string why_undecoded{};
  std::uint64_t undecoded = 0;  // messages whose bytes do not fit

  std::uint64_t pauses_with_hole = 0;  // between two messages, where the copy has a hole
  std::int64_t time_with_hole = 0;     // ns, of these pauses

  // Messages a second, from the first to the last, but for pauses with a hole. 0: too few messages to say.
  double rate() const;
};

class BagInfo {
 public:
  // Both must outlive it. Types are first looked for in the bag, then in `library`.
  BagInfo(const BagContents& contents, ros2::MessageLibrary& library)
      : contents_(contents), library_(library) {}
  BagInfo(const BagInfo&) = delete;

  void add(const BagMessage& message);
  // After the last message: all topics by name, also those that were announced only.
  std::vector<TopicInfo> topics();

  std::uint64_t messages() const { return messages_; }
  std::int64_t first() const { return first_; }              // as BagMessage::at
  std::int64_t first_clock() const { return first_clock_; }  // as recorded
  std::int64_t last() const { return last_; }
  std::int64_t last_clock() const { return last_clock_; }

 private:
  struct Topic {
    TopicInfo info;
    bool is_planned = false;
    std::optional<ros2::FieldReader> whole;
    std::int64_t heard_since = 0;  // the last message, or the end of a hole after it
    std::int64_t heard_clock = 0;
    bool is_after_hole = false;  // since its last message
  };
  void plan(Topic& topic, const BagTopic& about);
  void note_gap(Topic& topic, std::int64_t until);

  const BagContents& contents_;
  ros2::MessageLibrary& library_;
  std::vector<Topic> topics_;
  std::uint64_t messages_ = 0;
  std::int64_t first_ = 0;
  std::int64_t first_clock_ = 0;
  std::int64_t last_ = 0;
  std::int64_t last_clock_ = 0;
};

}  // namespace culprit::bag
