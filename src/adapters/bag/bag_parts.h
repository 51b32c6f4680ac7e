// Which files make up a recording: what its metadata.yaml says, and what is there.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bag/bag_contents.h"
#include "base/expected.h"

namespace culprit::bag {

enum class PartFormat : std::uint8_t { kSqlite, kMcap };

struct BagPart {
  std::filesystem::path path;
  PartFormat format = PartFormat::kSqlite;
  bool is_after_missing = false;  // the part before it is not there
};

struct BagParts {
  std::vector<BagPart> parts;  // as metadata.yaml orders them; without it by their names
  bool is_ordered =
      false;  // they were recorded in this order, as metadata.yaml or their numbers say
  std::vector<std::string> missing;  // for people, a line each: parts that are not there
  std::vector<std::string>
      foreign;                   // likewise: recordings that are none of its parts, or were renamed
  std::vector<BagTopic> topics;  // that metadata.yaml announces
  std::optional<std::uint64_t> messages;  // of all parts, by metadata.yaml
};

// The parts of a file or a folder. Errors say why it is no rosbag2 recording: a ROS 1 bag, a pointer of
// Git LFS, an empty folder.
Expected<BagParts> find_parts(const std::filesystem::path& path);

// Whether the file's name is that of a recording, of ROS 1 or 2.
bool has_name_of_bag(const std::filesystem::path& path);

// Why these first bytes are no rosbag2 recording, if they show it; else empty.
std::string why_no_part(const std::filesystem::path& path);

}  // namespace culprit::bag
