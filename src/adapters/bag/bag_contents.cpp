#include "bag/bag_contents.h"

#include <algorithm>

namespace culprit::bag {
namespace {

constexpr std::size_t kMostLines = 20;
constexpr std::size_t kMostQosBytes = std::size_t{16} << 20;  // of all topics

// Recorders before Dashing, and tools that convert ROS 1 bags, write sensor_msgs/Image.
std::string full_type(std::string type) {
  const std::size_t slash = type.find('/');
  if (slash != std::string::npos && type.find('/', slash + 1) == std::string::npos)
    type.insert(slash, "/msg");
  return type;
}

}  // namespace

std::size_t BagContents::place_of(BagTopic topic) {
  // ros2 bag play publishes a relative name below the root, too.
  if (!topic.name.starts_with('/')) topic.name.insert(0, 1, '/');
  topic.type = full_type(std::move(topic.type));
  const auto [place, is_new] = places_.try_emplace({topic.name, topic.type}, topics_.size());
  if (!is_new) return place->second;
  if (topic.offered_qos.size() > kMostQosBytes - qos_bytes_) topic.offered_qos.clear();
  qos_bytes_ += topic.offered_qos.size();
  topics_.push_back(std::move(topic));
  return place->second;
}

void BagContents::define(std::string_view type, std::string_view text) {
  constexpr std::size_t kMostBytes = std::size_t{64} << 20;  // of all definitions
  // Recorders that do not find the definition of a type write an empty one.
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) return;
  if (text.size() > kMostBytes - definition_bytes_) return;
  const bool is_new = definitions_.try_emplace(full_type(std::string(type)), text).second;
  if (is_new) definition_bytes_ += text.size();
}

const std::string* BagContents::definition_of(const std::string& type) const {
  const bool is_message = type.find("/msg/") != std::string::npos;
  // The text of a service or an action may stand under its own name: of X_SendGoal_Event under X.
  for (std::size_t end = type.size(); end != std::string::npos && end > 0;
       end = type.rfind('_', end - 1)) {
    const auto found = definitions_.find(type.substr(0, end));
    if (found != definitions_.end()) return &found->second;
    if (is_message) break;
  }
  return nullptr;
}

void BagContents::lose(std::string what) {
  if (std::ranges::find(losses_, what) != losses_.end()) return;
  if (losses_.size() < kMostLines) {
    losses_.push_back(std::move(what));
  } else {
    ++more_losses_;
  }
}

void BagContents::remark(std::string what) {
  if (remarks_.size() < kMostLines) remarks_.push_back(std::move(what));
}

void BagContents::note_jump(ClockJump jump) {
  constexpr std::size_t kMostJumps = 1000;
  if (jumps_.size() < kMostJumps) jumps_.push_back(jump);
}

std::vector<std::string> BagContents::losses() const {
  std::vector<std::string> all = losses_;
  if (more_losses_ > 0) all.push_back("and " + std::to_string(more_losses_) + " more like these");
  std::vector<std::string> counted;
  for (const auto& [why, count] : lost_messages_)
    counted.push_back(std::to_string(count) + (count == 1 ? " message " : " messages ") +
                      std::string(why));
  std::sort(counted.begin(), counted.end());
  all.insert(all.end(), counted.begin(), counted.end());
  return all;
}

}  // namespace culprit::bag
