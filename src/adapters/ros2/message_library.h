// The message definitions that are to be had: those that were learned, files under the search
// directories, then the standard types built in.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "ros2/message_definition.h"

namespace culprit::ros2 {

// Reads a definition when it is first asked for, and keeps it. One thread.
class MessageLibrary {
 public:
  // In each directory, the first one first: <package>/msg/<Type>.msg, then
  // share/<package>/msg/<Type>.msg.
  explicit MessageLibrary(std::vector<std::filesystem::path> directories = {});

  // What a recorder or another program keeps of `type`: the text of its .msg file, then those of
  // the types in it, each after a line of 80 '=' and one "MSG: package/Type"
  // (mcap.dev/spec/registry, ros2msg). Goes before the directories; the first one of a type counts.
  void learn(std::string_view type, std::string_view text);

  // `type` is "package/msg/Type". The definition lives as long as the library.
  Expected<const MessageDefinition*> find(std::string_view type);

 private:
  Expected<MessageDefinition> load(std::string_view type) const;

  std::vector<std::filesystem::path> directories_;
  std::map<std::string, std::string, std::less<>> learned_;  // texts
  std::map<std::string, MessageDefinition, std::less<>> known_;
};

// `first` (--message-path), then the entries of `ament_prefix_path` as the variable
// AMENT_PREFIX_PATH holds them.
std::vector<std::filesystem::path> message_directories(std::vector<std::filesystem::path> first,
                                                       std::string_view ament_prefix_path);

}  // namespace culprit::ros2
