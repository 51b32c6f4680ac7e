#include "ros2/message_library.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "ros2/names.h"
#include "ros2/standard_messages.h"

namespace culprit::ros2 {

MessageLibrary::MessageLibrary(std::vector<std::filesystem::path> directories)
    : directories_(std::move(directories)) {}

Expected<const MessageDefinition*> MessageLibrary::find(std::string_view type) {
  if (const auto known = known_.find(type); known != known_.end()) return &known->second;
  // The name may come from the network, and becomes part of a path.
  if (!is_valid_type_name(type))
    return Error{"'" + printable(type) + "' is not the name of a type"};
  auto loaded = load(type);
  if (!loaded) return Error{loaded.error()};
  return &known_.emplace(type, std::move(*loaded)).first->second;
}

Expected<MessageDefinition> MessageLibrary::load(std::string_view type) const {
  const std::filesystem::path below = std::string(type) + ".msg";
  for (const auto& directory : directories_) {
    for (const auto& path : {directory / below, directory / "share" / below}) {
      std::ifstream file(path);
      if (!file) continue;
      const std::string text(std::istreambuf_iterator<char>(file), {});
      return parse_message_definition(text, type, path.string());
    }
  }
  if (const auto text = standard_message(type)) {
    return parse_message_definition(*text, type, type);
  }
  return Error{"the message type " + std::string(type) +
               " is not known; give the directory that holds " + below.string() +
               " with --message-path"};
}

std::vector<std::filesystem::path> message_directories(std::vector<std::filesystem::path> first,
                                                       std::string_view ament_prefix_path) {
  while (!ament_prefix_path.empty()) {
    const auto end = std::min(ament_prefix_path.find(':'), ament_prefix_path.size());
    if (end > 0) first.emplace_back(ament_prefix_path.substr(0, end));
    ament_prefix_path.remove_prefix(std::min(end + 1, ament_prefix_path.size()));
  }
  return first;
}

}  // namespace culprit::ros2
