// A black box: keeps the last seconds of a robot in memory, and writes a recording when something goes wrong, from some
// seconds before to some seconds after.
//
//     IncidentRecorder recorder({.folder = "recordings", .robot = "submarine"});
//     const std::size_t chatter = recorder.add_topic({"/chatter", "std_msgs/msg/String", …});
//     recorder.take(chatter, {…});                      // each message, on whichever thread it comes
//     recorder.begin("CameraDead");                     // a failure
//     recorder.over();                                  // all is well again
//
// Nobody waits for a disk: a thread of its own, of low priority, opens, writes and ends the files.
// A failure to write is reported once, and the next recording tries again.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "recorder/message_ring.h"
#include "recorder/recording_file.h"
#include "recorder/recording_folder.h"

namespace culprit::recorder {

// All members may be called from any thread.
class IncidentRecorder {
 public:
  // A recording that is not ended is ended after so long.
  static constexpr Duration kLongest = std::chrono::minutes(5);
  // A killed process loses at most so much.
  static constexpr Duration kFlushes = std::chrono::seconds(1);

  // So many at most, over all the time: the network decides how many there are.
  static constexpr std::size_t kMostTopics = 10'000;
  static constexpr std::size_t kNoTopic = SIZE_MAX;

  static constexpr const char* kEventsTopic = "/culprit/events";
  static constexpr const char* kGraphTopic = "/culprit/graph";

  struct Options {
    std::filesystem::path folder;
    std::string robot;    // its name
    std::string library;  // the program that writes it: "culprit 0.1.0"
    Duration before = std::chrono::seconds(20);
    Duration after = std::chrono::seconds(10);
    std::size_t memory = 200'000'000;    // bytes, of all that is kept
    std::uint64_t disk = 5'000'000'000;  // bytes, of all recordings
    RecordingFolder::SpaceOf space = RecordingFolder::space_of;
    // Receives messages for people: failures, and recordings that were written. Called on the
    // recorder's thread.
    std::function<void(const std::string&)> say = [](const std::string&) {};
  };

  explicit IncidentRecorder(Options options);
  // Ends the recording that is on.
  ~IncidentRecorder();
  IncidentRecorder(const IncidentRecorder&) = delete;

  // The parts of the memory for large messages, and for latched ones.
  static std::size_t large_share(std::size_t memory) { return memory / 4; }
  static std::size_t latched_share(std::size_t memory) { return memory / 10; }

  // Gives the number of the topic; the same for the same name, type and hash. Its other data
  // replace the earlier ones, except in recordings that have those already. kNoTopic: there are too
  // many; the topic is not kept.
  std::size_t add_topic(RecordedTopic topic);
  // `number` and `at` are filled in, and `received`, if it is not given, with the same moment.
  void take(RingMessage message, Share share = Share::kSmall);
  // As take(), for a latched topic, whose last message stays.
  void take_latched(RingMessage message, const rtps::Guid& publisher, Share share);

  // An event of culprit (a failure, a decision, an action): a JSON document.
  void note_event(const std::string& json);
  // The robot's graph from now on, in the same form.
  void note_graph(const std::string& json);

  // A failure, called `why`, which is there until over(). If a recording is on, it goes on.
  void begin(const std::string& why);
  void over();
  // Somebody wants a recording, for Options::after from now on. Gives where it is, once it has begun. Errors: it could
  // not begin, or not within `patience`.
  Expected<std::filesystem::path> record_now(const std::string& why, Duration patience);

  const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  // Replaced, never changed: the thread has one while it writes.
  using SharedTopic = std::shared_ptr<const RecordedTopic>;
  // A request to the thread.
  struct Wish {
    std::string why;        // empty: nothing
    std::int64_t when = 0;  // nanoseconds since 1970
    Time at{};
    std::uint64_t number = 0;
  };

  void want(const std::string& why) CULPRIT_REQUIRES(mutex_);
  void work();
  void open(const Wish& wish);
  void write_new(Time since);
  void close();
  void say_once(const std::string& text);
  SharedTopic topic_of(const RingMessage& message);
  RingMessage told(std::size_t topic, const std::string& json) const;

  const Options options_;
  const RecordingFolder folder_;
  MessageRing ring_;

  Mutex topics_mutex_;
  std::vector<SharedTopic> topics_ CULPRIT_GUARDED_BY(topics_mutex_);
  std::map<std::string, std::size_t> numbers_ CULPRIT_GUARDED_BY(topics_mutex_);
  std::size_t events_ = 0;
  std::size_t graph_ = 0;

  Mutex mutex_;
  ConditionVariable changed_;
  Wish wish_ CULPRIT_GUARDED_BY(mutex_);
  std::uint64_t wishes_ CULPRIT_GUARDED_BY(mutex_) = 0;
  bool is_ill_ CULPRIT_GUARDED_BY(mutex_) = false;
  Time until_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;  // of the recording, if nothing is wrong
  bool is_ending_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::uint64_t answered_ CULPRIT_GUARDED_BY(mutex_) = 0;  // the last wish that was met, or not
  Expected<std::filesystem::path> answer_ CULPRIT_GUARDED_BY(mutex_) = Error{"it has not begun"};

  // Used by the thread only.
  std::unique_ptr<RecordingFile> file_;  // null: none is on
  std::uint64_t written_ = 0;            // the last message that is in it
  Time since_{};                         // what it begins with
  Time opened_{};
  std::string trouble_;  // the last one that was reported

  std::thread thread_;  // last: it begins when all is there
};

}  // namespace culprit::recorder
