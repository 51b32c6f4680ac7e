#include "bag/bag_parts.h"

#include <algorithm>
#include <fstream>
#include <string_view>

#include <yaml-cpp/yaml.h>

#include "bag/byte_source.h"
#include "base/text_file.h"

namespace culprit::bag {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMetadata = "metadata.yaml";

fs::path uncompressed_name(fs::path path) {
  return is_compressed(path) ? path.replace_extension() : path;
}

bool is_part(const fs::path& path) {
  const std::string extension = uncompressed_name(path).extension();
  return extension == ".db3" || extension == ".mcap";
}

// name_0.db3, name_1.db3 ... name_10.db3
bool is_earlier(const fs::path& a, const fs::path& b) {
  const std::string left = uncompressed_name(a).string();
  const std::string right = uncompressed_name(b).string();
  if (left != right) return left.size() != right.size() ? left.size() < right.size() : left < right;
  return !is_compressed(a) && is_compressed(b);
}

// All are name_<number>, of one name.
bool are_numbered(const std::vector<fs::path>& parts) {
  std::string name;
  for (const fs::path& path : parts) {
    const std::string stem = uncompressed_name(path).stem();
    const std::size_t end = stem.find_last_not_of("0123456789");
    if (end == std::string::npos || end + 1 == stem.size() || stem[end] != '_') return false;
    if (!name.empty() && name != stem.substr(0, end)) return false;
    name = stem.substr(0, end);
  }
  return !name.empty();
}

std::string first_bytes(const fs::path& path) {
  std::string bytes(64, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return bytes;
}

// The first bytes decide the format; people and other tools may have renamed the file.
BagPart part_at(const fs::path& path) {
  const std::string bytes = first_bytes(path);
  const bool is_named_mcap = uncompressed_name(path).extension() == ".mcap";
  const bool is_mcap = bytes.starts_with("\x89MCAP0\r\n") ||
                       (is_named_mcap && !bytes.starts_with("SQLite format 3"));
  return {path, is_mcap ? PartFormat::kMcap : PartFormat::kSqlite};
}

struct Metadata {
  std::vector<std::string> files;
  std::vector<BagTopic> topics;
  std::optional<std::uint64_t> messages;
};

template <class T>
T or_default(const YAML::Node& node) {
  return node && node.IsScalar() ? node.as<T>(T()) : T();
}

// The parser takes hundreds of bytes for each piece, and microseconds. A bag of 10,000 topics has fewer pieces.
bool has_too_many_pieces(std::string_view text) {
  constexpr std::ptrdiff_t kMost = 1 << 19;
  constexpr std::string_view kMarks = ",[]{}:?-\n\"'";
  return std::ranges::count_if(text, [&](char c) { return kMarks.find(c) != kMarks.npos; }) > kMost;
}

// Nothing: it is not there, or cannot be read.
std::optional<Metadata> read_metadata(const fs::path& folder) {
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{16} << 20;
  std::error_code error;
  const fs::path path = folder / kMetadata;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || size > kMostBytes) return std::nullopt;
  const auto text = read_text(path.string());
  if (!text || has_too_many_pieces(*text)) return std::nullopt;
  try {
    const YAML::Node all = YAML::Load(*text)["rosbag2_bagfile_information"];
    Metadata metadata;
    if (!all || !all.IsMap() || !all["relative_file_paths"].IsSequence()) return std::nullopt;
    for (const YAML::Node& each : all["relative_file_paths"])
      metadata.files.push_back(or_default<std::string>(each));
    if (const YAML::Node count = all["message_count"]; count && count.IsScalar())
      metadata.messages = count.as<std::uint64_t>();
    const YAML::Node topics = all["topics_with_message_count"];
    for (std::size_t t = 0; topics.IsSequence() && t < topics.size(); ++t) {
      const YAML::Node about = topics[t]["topic_metadata"];
      if (!about || !about.IsMap()) continue;
      BagTopic topic{or_default<std::string>(about["name"]), or_default<std::string>(about["type"]),
                     or_default<std::string>(about["serialization_format"])};
      const YAML::Node qos = about["offered_qos_profiles"];
      if (qos && qos.IsScalar()) topic.offered_qos = qos.as<std::string>();
      if (qos && qos.IsSequence()) topic.offered_qos = YAML::Dump(qos);
      if (!topic.name.empty()) metadata.topics.push_back(std::move(topic));
    }
    return metadata;
  } catch (const YAML::Exception&) {
    return std::nullopt;
  }
}

// Recorders before Foxy wrote the folder before the name; a part may have been compressed or decompressed since.
std::optional<fs::path> find_file(const fs::path& folder, const std::string& name) {
  const fs::path own = fs::path(name).filename();
  for (const fs::path& path :
       {folder / own, fs::path((folder / own).string() + ".zstd"),
        fs::path((folder / own).string() + ".zst"), uncompressed_name(folder / own)}) {
    std::error_code error;
    if (!own.empty() && fs::is_regular_file(path, error)) return path;
  }
  return std::nullopt;
}

void order_by_metadata(const fs::path& folder, const Metadata& metadata,
                       const std::vector<fs::path>& there, BagParts& all) {
  std::vector<fs::path> used;
  bool is_after_missing = false;
  for (const std::string& name : metadata.files) {
    const auto path = find_file(folder, name);
    if (!path) {
      all.missing.push_back(fs::path(name).filename().string() +
                            ": metadata.yaml names this part, but it is not in the folder");
      is_after_missing = true;
      continue;
    }
    if (std::ranges::find(used, uncompressed_name(*path)) != used.end()) continue;
    BagPart part = part_at(*path);
    part.is_after_missing = is_after_missing;
    is_after_missing = false;
    used.push_back(uncompressed_name(*path));
    all.parts.push_back(std::move(part));
  }
  for (const fs::path& path : there) {
    if (std::ranges::find(used, uncompressed_name(path)) == used.end())
      all.foreign.push_back(path.filename().string() +
                            ": metadata.yaml does not name this file; it is left out");
  }
}

// "a, b and more": the folders in it that are recordings.
std::string recordings_below(const fs::path& folder) {
  constexpr std::size_t kMostNamed = 5;
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (!entry.is_directory(error)) continue;
    const fs::directory_iterator inside(entry.path(), error);
    if (!error && std::any_of(begin(inside), end(inside),
                              [](const fs::directory_entry& file) { return is_part(file.path()); }))
      names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  std::string all;
  for (std::size_t i = 0; i < std::min(names.size(), kMostNamed); ++i)
    all += (i == 0 ? "" : ", ") + names[i];
  return names.size() > kMostNamed ? all + " and more" : all;
}

// People rename a recording, but not what metadata.yaml says of it. Its count of messages then tells
// whether these are all.
void take_renamed(const std::vector<std::string>& names, const std::vector<fs::path>& there,
                  BagParts& all) {
  all.missing.clear();
  for (std::size_t p = 0; p < there.size(); ++p)
    all.foreign.push_back(there[p].filename().string() + ": metadata.yaml calls this part " +
                          fs::path(names[p]).filename().string() + "; the file was renamed");
}

}  // namespace

bool has_name_of_bag(const fs::path& path) { return is_part(path) || path.extension() == ".bag"; }

std::string why_no_part(const fs::path& path) {
  const std::string bytes = first_bytes(path);
  std::error_code error;
  if (bytes.starts_with("version https://git-lfs"))
    return "it is a Git LFS pointer, not the recording itself; get that with git lfs pull";
  if (bytes.starts_with("#ROSBAG"))
    return "it is a ROS 1 bag; convert it with rosbags-convert --src " + path.filename().string() +
           " --dst " + path.stem().string();
  if (bytes.empty() && fs::file_size(path, error) == 0 && !error) return "the file is empty";
  return "";
}

Expected<BagParts> find_parts(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return Error{"there is no such bag"};
  BagParts all;
  if (!fs::is_directory(path, error)) {
    if (const std::string why = why_no_part(path); !why.empty()) return Error{why};
    if (path.extension() == ".rules") return Error{"it is a rule file; culprit check reads it"};
    if (!is_part(path)) return Error{"it ends neither in .db3 nor in .mcap, or that with .zstd"};
    all.parts.push_back(part_at(path));
    return all;
  }
  std::vector<fs::path> there;
  bool has_ros1 = false;
  std::error_code unreadable;
  for (const auto& entry : fs::directory_iterator(path, error)) {
    // Opening a pipe would wait for its writer.
    if (is_part(entry.path()) && entry.is_regular_file(unreadable)) there.push_back(entry.path());
    has_ros1 |= entry.path().extension() == ".bag";
  }
  if (error) return Error{error.message()};
  std::sort(there.begin(), there.end(), is_earlier);
  // ros2 bag play leaves a part that it decompressed beside the compressed one.
  const auto is_same = [](const fs::path& a, const fs::path& b) {
    return uncompressed_name(a) == uncompressed_name(b);
  };
  there.erase(std::unique(there.begin(), there.end(), is_same), there.end());
  const auto metadata = read_metadata(path);
  if (metadata && !metadata->files.empty()) {
    all.is_ordered = true;
    all.topics = metadata->topics;
    all.messages = metadata->messages;
    order_by_metadata(path, *metadata, there, all);
    if (!all.parts.empty()) return all;
    all.foreign.clear();
    if (there.size() == metadata->files.size()) {
      take_renamed(metadata->files, there, all);
    } else {
      all.messages.reset();
    }
  }
  all.is_ordered = are_numbered(there);
  for (const fs::path& each : there) all.parts.push_back(part_at(each));
  if (!all.parts.empty()) return all;
  if (has_ros1) return Error{"it holds a ROS 1 bag; convert that with rosbags-convert"};
  if (const std::string folders = recordings_below(path); !folders.empty())
    return Error{"it holds the recordings " + folders + "; name one or several of them"};
  return Error{"there is no .db3 or .mcap file in it, nor one with .zstd"};
}

}  // namespace culprit::bag
