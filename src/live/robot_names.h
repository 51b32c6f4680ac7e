// The live robot's names, for forms: looked up only on request.
#pragma once

#include "base/mutex.h"
#include "live/robot_survey.h"

namespace culprit::live {

class RobotNames {
 public:
  explicit RobotNames(std::vector<std::filesystem::path> message_path = {})
      : message_path_(std::move(message_path)) {}

  // web::Look. The first call finds little, for discovery takes a moment. Errors: the domain cannot
  // be joined. From any thread.
  Expected<LiveInventory> look(const LiveInterest& interest);
  // The last lines that a node has logged since this was called first, the newest last. Errors: the same.
  Expected<std::vector<ros2::msg::Log>> log_of(const std::string& node);
  // The content of a map view (Survey::map()). Errors: the same.
  Expected<link::MapPicture> map(const std::string& topic, std::uint64_t known);

 private:
  Expected<void> open() CULPRIT_REQUIRES(mutex_);

  const std::vector<std::filesystem::path> message_path_;
  Mutex mutex_;
  std::unique_ptr<link::Survey> survey_ CULPRIT_GUARDED_BY(mutex_);  // null: nobody has asked yet
  LiveInterest interest_ CULPRIT_GUARDED_BY(mutex_);                 // of all who asked
};

}  // namespace culprit::live
