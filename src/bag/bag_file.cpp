#include "bag/bag_file.h"

#include <algorithm>

namespace culprit::bag {
namespace {

namespace fs = std::filesystem;

// name_0.db3, name_1.db3 ... name_10.db3
bool is_earlier(const fs::path& a, const fs::path& b) {
  const std::string left = a.string();
  const std::string right = b.string();
  return left.size() != right.size() ? left.size() < right.size() : left < right;
}

Expected<std::vector<fs::path>> parts_of(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return Error{"there is no such bag"};
  if (!fs::is_directory(path)) return std::vector{path};
  std::vector<fs::path> parts;
  bool has_other = false;
  for (const auto& entry : fs::directory_iterator(path, error)) {
    const std::string extension = entry.path().extension();
    if (extension == ".db3") parts.push_back(entry.path());
    has_other |= extension == ".mcap" || extension == ".zstd";
  }
  if (parts.empty())
    return Error{has_other ? "it is MCAP or compressed; ros2 bag convert makes a plain SQLite3 bag"
                           : "there is no .db3 file in it"};
  std::sort(parts.begin(), parts.end(), is_earlier);
  return parts;
}

}  // namespace

bool is_bag(const fs::path& path) {
  std::error_code error;
  const std::string extension = path.extension();
  return fs::is_directory(path, error) || extension == ".db3" || extension == ".mcap";
}

Expected<BagFile> BagFile::open(const fs::path& path) {
  const auto failure = [&](const std::string& why) {
    return Error{"cannot read the bag '" + path.string() + "': " + why};
  };
  if (path.extension() == ".mcap")
    return failure("it is MCAP; ros2 bag convert makes a plain SQLite3 bag");
  const auto parts = parts_of(path);
  if (!parts) return failure(parts.error());
  BagFile bag;
  for (const fs::path& part : *parts) {
    if (const auto added = bag.add(part); !added)
      return failure(part.filename().string() + ": " + added.error());
  }
  return bag;
}

Expected<void> BagFile::add(const fs::path& path) {
  auto database = journal::Database::open(path, journal::Database::Mode::kRead);
  if (!database) return Error{database.error()};
  Part part{std::move(*database), {}};
  auto rows = part.database.prepare("SELECT id, name, type, serialization_format FROM topics");
  if (!rows) return Error{"it is no bag (" + rows.error() + ")"};
  auto more = rows->step();
  for (; more && *more; more = rows->step()) {
    if (rows->bytes(3) != "cdr")
      return Error{"its messages are not in CDR but in '" + std::string(rows->bytes(3)) + "'"};
    part.topics.emplace_back(rows->integer(0),
                             place_of({std::string(rows->bytes(1)), std::string(rows->bytes(2))}));
  }
  if (!more) return Error{more.error()};
  parts_.push_back(std::move(part));
  return {};
}

std::size_t BagFile::place_of(BagTopic topic) {
  const auto found = std::find_if(topics_.begin(), topics_.end(),
                                  [&](const BagTopic& each) { return each.name == topic.name; });
  if (found != topics_.end()) return static_cast<std::size_t>(found - topics_.begin());
  topics_.push_back(std::move(topic));
  return topics_.size() - 1;
}

Expected<bool> BagFile::next(BagMessage& message) {
  for (; part_ < parts_.size(); ++part_, rows_.reset()) {
    const Part& part = parts_[part_];
    if (!rows_) {
      auto rows = part.database.prepare(
          "SELECT timestamp, topic_id, data FROM messages ORDER BY timestamp, id");
      if (!rows) return Error{"it is no bag (" + rows.error() + ")"};
      rows_ = std::move(*rows);
    }
    while (true) {
      const auto more = rows_->step();
      if (!more) return more;
      if (!*more) break;
      const std::int64_t number = rows_->integer(1);
      const auto topic = std::find_if(part.topics.begin(), part.topics.end(),
                                      [&](const auto& each) { return each.first == number; });
      // Times that no recorder writes are damage, with which nobody should calculate.
      constexpr std::int64_t kYear2100 = 4'102'444'800'000'000'000;
      const bool is_plausible = rows_->integer(0) >= 0 && rows_->integer(0) < kYear2100;
      if (topic == part.topics.end() || !is_plausible) continue;
      message = {rows_->integer(0), topic->second, rows_->bytes(2)};
      return true;
    }
  }
  return false;
}

}  // namespace culprit::bag
