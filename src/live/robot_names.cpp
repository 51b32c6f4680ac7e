#include "live/robot_names.h"

#include <algorithm>

namespace culprit::live {
namespace {

constexpr std::size_t kMostNodes = 1000;

}  // namespace

Expected<void> RobotNames::open() {
  if (survey_ != nullptr) return {};
  auto survey = open_survey(message_path_);
  if (!survey) return Error{survey.error()};
  survey_ = std::move(*survey);
  return {};
}

Expected<LiveInventory> RobotNames::look(const LiveInterest& interest) {
  const MutexLock lock(mutex_);
  if (const auto opened = open(); !opened) return Error{opened.error()};
  LiveInterest all = interest;
  // Two pages look at different nodes. Names that a person has typed half are dropped in the end.
  if (interest_.nodes.size() < kMostNodes)
    all.nodes.insert(interest_.nodes.begin(), interest_.nodes.end());
  if (all != interest_) survey_->ask_for(interest_ = all);
  return survey_->inventory();
}

// Loggers are called as their nodes, with points: "/perception/camera" logs as "perception.camera".
Expected<std::vector<ros2::msg::Log>> RobotNames::log_of(const std::string& node) {
  const MutexLock lock(mutex_);
  if (const auto opened = open(); !opened) return Error{opened.error()};
  survey_->listen_to_log();
  std::string logger = node.substr(node.empty() || node.front() != '/' ? 0 : 1);
  std::ranges::replace(logger, '/', '.');
  return survey_->log_of(logger);
}

// A large map takes a moment, in which others can look: the survey stays once it is there.
Expected<link::MapPicture> RobotNames::map(const std::string& topic, std::uint64_t known) {
  link::Survey* survey = nullptr;
  {
    const MutexLock lock(mutex_);
    if (const auto opened = open(); !opened) return Error{opened.error()};
    survey = survey_.get();
  }
  return survey->map(topic, known);
}

}  // namespace culprit::live
