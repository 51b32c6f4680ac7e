// The robot that check and lsp look at with --robot: the one that the environment names.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "link/survey.h"

namespace culprit::live {

// Where message types are looked for: `message_path`, then AMENT_PREFIX_PATH, then what nodes told
// of earlier, which is kept in the state folder.
link::TypeFinder::Options sources_of_types(std::vector<std::filesystem::path> message_path);

// `message_path` is where to find .msg files, before AMENT_PREFIX_PATH. The domain and how to get
// there are taken from the environment (ROS_DOMAIN_ID and its kin). Errors: the environment is
// wrong, or the domain cannot be joined.
Expected<std::unique_ptr<link::Survey>> open_survey(
    std::vector<std::filesystem::path> message_path = {});

}  // namespace culprit::live
