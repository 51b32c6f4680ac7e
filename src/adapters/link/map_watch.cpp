#include "link/map_watch.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/live_clock.h"
#include "base/name_grammar.h"

namespace culprit::link {
namespace {

constexpr std::size_t kMostRobots = 16;
// The network decides how many there are.
constexpr std::size_t kMostBases = 64;  // that are placed
constexpr std::size_t kMostTopics = 100;

// The last part of the name of the usual topic of a type, as Nav2 and slam_toolbox have it.
struct Usual {
  std::string_view type;
  std::string_view name;
};
constexpr std::array kUsual = {Usual{ros2::msg::OccupancyGrid::kType, "map"},
                               Usual{ros2::msg::Path::kType, "plan"},
                               Usual{ros2::msg::LaserScan::kType, "scan"}};

// The topics of a type, the usual one first.
std::vector<MapWatch::Topic> topics_of(const std::vector<MapWatch::Topic>& all,
                                       const Usual& usual) {
  std::vector<MapWatch::Topic> found;
  std::ranges::copy_if(all, std::back_inserter(found),
                       [&](const auto& topic) { return topic.type == usual.type; });
  std::ranges::sort(found, {}, [&](const auto& topic) {
    const std::string_view name = topic.name;
    return std::tuple(name.substr(name.rfind('/') + 1) != usual.name, name.size(), name);
  });
  return found;
}

}  // namespace

void MapWatch::follow(const std::vector<Topic>& topics, const std::string& wanted) {
  for (const Part part : {kGrid, kPath, kScan}) {
    const std::vector<Topic> found = topics_of(topics, kUsual[part]);
    const auto chosen = std::ranges::find(found, wanted, &Topic::name);
    if (!found.empty()) listen(part, chosen == found.end() ? found.front() : *chosen);
    if (part != kGrid) continue;
    const MutexLock lock(mutex_);
    topics_.clear();
    for (std::size_t i = 0; i < std::min(found.size(), kMostTopics); ++i)
      topics_.push_back(found[i].name);
  }
  const rtps::Qos latched{.durability = rtps::Durability::kTransientLocal, .depth = 100};
  listen(kTransforms, {"/tf", std::string(ros2::msg::TFMessage::kType), rtps::qos::kSensorData});
  listen(kStaticTransforms, {"/tf_static", std::string(ros2::msg::TFMessage::kType), latched});
}

// Best effort, so that it holds no publisher back; but only a reliable reader receives a latched map (topic_listener.h).
void MapWatch::listen(Part part, const Topic& topic) {
  Source& source = sources_[part];
  const bool latches = topic.offered.durability == rtps::Durability::kTransientLocal &&
                       topic.offered.reliability == rtps::Reliability::kReliable;
  if (source.subscription && source.topic == topic.name && source.latches == latches) return;
  rtps::Qos qos{
      .reliability = rtps::Reliability::kBestEffort, .depth = 100, .keys = topic.offered.keys};
  if (latches)
    qos = {
        .durability = rtps::Durability::kTransientLocal, .depth = 100, .keys = topic.offered.keys};
  if (part <= kScan) qos.depth = 1;
  auto made =
      ros2::RawSubscription::create(self_, topic.name, topic.type, qos, ros2::PayloadUse::kWhole,
                                    [this, part, name = topic.name](const ros2::Sample& sample) {
                                      on_sample(part, name, sample);
                                    });
  if (!made) return;
  source = {topic.name, latches, std::move(*made)};
}

void MapWatch::stop() {
  sources_ = {};
  const MutexLock lock(mutex_);
  topics_.clear();
  newest_ = {};
  frames_ = {};
  grid_ = Error{""};
  decoded_ = 0;
}

void MapWatch::on_sample(Part part, const std::string& topic, const ros2::Sample& sample) {
  if (part <= kScan) {
    const MutexLock lock(mutex_);
    const std::size_t most = part == kGrid ? kMostBytes : kMostBytesOfOthers;
    return newest_[part].keep(topic, sample.payload, most, live_now(), messages_);
  }
  if (sample.payload.size() > kMostBytesOfOthers) return;
  const auto message = rtps::decode<ros2::msg::TFMessage>(sample.payload);
  if (!message) return;
  const MutexLock lock(mutex_);
  frames_.add(*message, part == kTransforms ? FrameTree::Kind::kMoving : FrameTree::Kind::kStatic,
              live_now());
}

// Without the lock: a large map takes a moment, and messages come meanwhile.
void MapWatch::decode_grid(Time now) {
  rtps::Bytes payload;
  std::uint64_t number = 0;
  {
    const MutexLock lock(mutex_);
    const NewestMessage& newest = newest_[kGrid];
    if (newest.number == decoded_ || now < later(decoded_at_, kGridPeriod)) return;
    payload = newest.payload;
    number = decoded_ = newest.number;
    decoded_at_ = now;
  }
  const auto message = rtps::decode<ros2::msg::OccupancyGrid>(payload);
  Expected<GridPicture> grid = message ? picture_of(*message) : Error{"it is cut off"};
  const MutexLock lock(mutex_);
  if (number != decoded_) return;
  grid_ = std::move(grid);
  if (grid_) frame_ = message->header.frame_id;
}

MapPicture MapWatch::picture(std::uint64_t known, Time now) {
  decode_grid(now);
  MapPicture picture;
  const MutexLock lock(mutex_);
  const NewestMessage& newest = newest_[kGrid];
  picture.topics = topics_;
  picture.topic = newest.topic;
  if (newest.refused > 0)
    picture.troubles.push_back("A map of " + std::to_string(newest.refused >> 20) +
                               " MB is not drawn; the limit is 64 MB");
  if (decoded_ == 0) return picture;
  picture.frame = frame_;
  picture.number = decoded_;
  if (!grid_) {
    picture.troubles.push_back(newest.topic + " is not drawn: " + grid_.error());
    return picture;
  }
  if (known != decoded_) picture.grid = *grid_;
  add_robots(picture, now);
  add_line<ros2::msg::Path>(picture, picture.path, newest_[kPath], now);
  add_line<ros2::msg::LaserScan>(picture, picture.scan, newest_[kScan], now);
  return picture;
}

void MapWatch::add_robots(MapPicture& picture, Time now) const {
  std::vector<std::string> bases = frames_.called("base_link");
  if (bases.empty()) bases = frames_.called("base_footprint");
  if (bases.size() > kMostBases) bases.resize(kMostBases);
  for (const std::string& base : bases) {
    const auto placed = frames_.place(base, frame_, now);
    if (!placed || picture.robots.size() == kMostRobots) continue;
    const auto& [t, rotation] = placed->transform;
    picture.robots.push_back({base, {t.x, t.y}, yaw_of(rotation), placed->age});
  }
  if (picture.robots.empty())
    picture.troubles.push_back(
        "The robot is not drawn: no transform on /tf leads from base_link to " + frame_);
}

template <class Message>
void MapWatch::add_line(MapPicture& picture, std::optional<MapPicture::Line>& line,
                        const NewestMessage& newest, Time now) const {
  if (newest.refused > 0)
    picture.troubles.push_back("A path or scan of " + std::to_string(newest.refused >> 20) +
                               " MB is not drawn; the limit is 4 MB");
  if (newest.number == 0) return;
  const auto message = rtps::decode<Message>(newest.payload);
  if (!message) return;
  const auto placed = frames_.place(message->header.frame_id, frame_, now);
  if (placed) {
    line.emplace(
        MapPicture::Line{newest.topic, points_of(*message, placed->transform), now - newest.at});
  } else {
    picture.troubles.push_back(newest.topic + " is not drawn: no transform on /tf leads from " +
                               printable(message->header.frame_id) + " to " + frame_);
  }
}

}  // namespace culprit::link
