// The message definitions that are to be had: those that were learned, files under the search
// directories, then the standard types built in.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
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
  // share/<package>/msg/<Type>.msg; of "package/srv/Type_Request" and "..._Response" the parts of
  // <package>/srv/<Type>.srv, and of "package/action/Type_Goal", "..._Result" and "..._Feedback" those of
  // <package>/action/<Type>.action. `root`: the folder that directories, and links below them, must
  // be below (/proc/PID/root for paths of a process in a container); nothing above it is read.
  explicit MessageLibrary(std::vector<std::filesystem::path> directories = {},
                          std::filesystem::path root = "/");

  // Adds the definition of `type` that a recorder or another program keeps: the text of its .msg
  // file, then those of the types in it, each after a line of 80 '=' and one "MSG: package/Type"
  // (mcap.dev/spec/registry, ros2msg). Goes before the directories; the first one of a type counts.
  // For a type that is made for a service or an action, as "package/srv/Type_Event", `text` may be that
  // of the .srv or .action file, as rosbag2 stores it.
  void learn(std::string_view type, std::string_view text);

  // `type` is "package/msg/Type" or a part as above. Types that consist of parts are known whether
  // their parts are or not: "package/srv/Type" itself, and of an action "..._SendGoal",
  // "..._GetResult", their requests and responses, and "..._FeedbackMessage" (rosidl). The
  // definition lives as long as the library.
  Expected<const MessageDefinition*> find(std::string_view type);

  // `type` and all types in it. Errors: as find(); more than a thousand of them.
  Expected<MessageDefinitions> with_parts(std::string_view type);
  // The hash that endpoints of this very type announce (type_description.h). Errors: as
  // with_parts().
  Expected<std::string> hash_of(std::string_view type);
  // Replaces all earlier definitions of those types.
  void define(const MessageDefinitions& definitions);

 private:
  void learn_one(std::string_view type, std::string_view text);
  Expected<MessageDefinition> load(std::string_view type) const;
  std::optional<std::string> read(const std::filesystem::path& path) const;

  std::vector<std::filesystem::path> directories_;
  std::filesystem::path root_;
  std::map<std::string, std::string, std::less<>> learned_;  // texts
  std::map<std::string, MessageDefinition, std::less<>> known_;
};

// `first` (--message-path), then the entries of `ament_prefix_path` as the variable
// AMENT_PREFIX_PATH holds them.
std::vector<std::filesystem::path> message_directories(std::vector<std::filesystem::path> first,
                                                       std::string_view ament_prefix_path);

}  // namespace culprit::ros2
