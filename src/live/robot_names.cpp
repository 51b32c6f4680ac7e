#include "live/robot_names.h"

namespace culprit::live {

Expected<LiveInventory> RobotNames::look(const LiveInterest& interest) {
  const MutexLock lock(mutex_);
  if (survey_ == nullptr) {
    auto survey = open_survey(message_path_);
    if (!survey) return Error{survey.error()};
    survey_ = std::move(*survey);
  }
  if (interest != interest_) survey_->ask_for(interest_ = interest);
  return survey_->inventory();
}

}  // namespace culprit::live
