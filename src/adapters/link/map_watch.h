// Follows the topics of a map view: one map, one path, one laser scan, and all transforms. It keeps the newest message of each as
// bytes, and decodes it when somebody asks.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "link/map_picture.h"
#include "link/newest_message.h"
#include "ros2/subscription.h"

namespace culprit::link {

class MapWatch {
 public:
  // Of a message; larger ones are refused. A map is decoded once, all else for each picture, or with each message.
  static constexpr std::size_t kMostBytes = 64UL << 20;
  static constexpr std::size_t kMostBytesOfOthers = 4UL << 20;
  static constexpr Duration kGridPeriod = std::chrono::seconds(1);  // a map is decoded so often

  struct Topic {
    std::string name;
    std::string type;
    rtps::Qos offered;
  };

  // `self` outlives it.
  explicit MapWatch(ros2::NodeEntry& self) : self_(self) {}

  // Subscribes to the map of this name, or the usual one if there is none, to a path and to a scan. On the executor's thread.
  void follow(const std::vector<Topic>& topics, const std::string& wanted);
  // Ends all subscriptions, and forgets what they brought. On the executor's thread.
  void stop();

  // With the map's cells, unless their number is `known`. From any thread.
  MapPicture picture(std::uint64_t known, Time now);

 private:
  enum Part : std::uint8_t { kGrid, kPath, kScan, kTransforms, kStaticTransforms, kParts };
  // Used by the executor's thread.
  struct Source {
    std::string topic;
    bool latches = false;
    std::unique_ptr<ros2::RawSubscription> subscription;
  };

  void listen(Part part, const Topic& topic);
  void on_sample(Part part, const std::string& topic, const ros2::Sample& sample);
  void decode_grid(Time now);
  void add_robots(MapPicture& picture, Time now) const CULPRIT_REQUIRES(mutex_);
  template <class Message>
  void add_line(MapPicture& picture, std::optional<MapPicture::Line>& line,
                const NewestMessage& newest, Time now) const CULPRIT_REQUIRES(mutex_);

  ros2::NodeEntry& self_;
  mutable Mutex mutex_;
  std::vector<std::string> topics_ CULPRIT_GUARDED_BY(mutex_);
  std::array<NewestMessage, kScan + 1> newest_ CULPRIT_GUARDED_BY(mutex_);
  FrameTree frames_ CULPRIT_GUARDED_BY(mutex_);
  std::uint64_t messages_ CULPRIT_GUARDED_BY(mutex_) = 0;
  // The map that was decoded last.
  std::uint64_t decoded_ CULPRIT_GUARDED_BY(mutex_) = 0;
  Time decoded_at_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;
  std::string frame_ CULPRIT_GUARDED_BY(mutex_);
  Expected<GridPicture> grid_ CULPRIT_GUARDED_BY(mutex_) = Error{""};

  std::array<Source, kParts> sources_;  // goes first: its samples come on another thread
};

}  // namespace culprit::link
