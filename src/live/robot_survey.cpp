#include "live/robot_survey.h"

#include "base/environment.h"

namespace culprit::live {

link::TypeFinder::Options sources_of_types(std::vector<std::filesystem::path> message_path) {
  return {ros2::message_directories(std::move(message_path), environment("AMENT_PREFIX_PATH")),
          default_state_folder() / "types"};
}

Expected<std::unique_ptr<link::Survey>> open_survey(
    std::vector<std::filesystem::path> message_path) {
  auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  link::Survey::Options survey;
  survey.participant = std::move(*participant);
  survey.types = sources_of_types(std::move(message_path));
  return link::Survey::open(std::move(survey));
}

}  // namespace culprit::live
