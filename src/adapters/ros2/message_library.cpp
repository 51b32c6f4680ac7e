#include "ros2/message_library.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "ros2/names.h"
#include "ros2/standard_messages.h"

namespace culprit::ros2 {

MessageLibrary::MessageLibrary(std::vector<std::filesystem::path> directories)
    : directories_(std::move(directories)) {}

void MessageLibrary::learn(std::string_view type, std::string_view text) {
  static const std::string kSeparator = '\n' + std::string(80, '=') + '\n';
  constexpr std::string_view kName = "MSG: ";
  std::string name(type);
  while (true) {
    const std::size_t end = std::min(text.find(kSeparator), text.size());
    learned_.try_emplace(std::move(name), text.substr(0, end));
    if (end == text.size()) return;
    text.remove_prefix(end + kSeparator.size());
    const std::size_t line = text.find('\n');
    if (!text.starts_with(kName) || line == std::string_view::npos) return;
    name = text.substr(kName.size(), line - kName.size());
    const std::size_t slash = name.find('/');
    if (slash != std::string::npos && name.find('/', slash + 1) == std::string::npos)
      name.insert(slash, "/msg");
    text.remove_prefix(line);  // The end of the line may begin the next separator.
  }
}

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
  if (const auto learned = learned_.find(type); learned != learned_.end())
    return parse_message_definition(learned->second, type, type);
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
