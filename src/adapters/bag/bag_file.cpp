#include "bag/bag_file.h"

#include <algorithm>

#include "bag/byte_source.h"
#include "bag/mcap_file.h"
#include "bag/sqlite_file.h"

namespace culprit::bag {
namespace {

namespace fs = std::filesystem;

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

Expected<std::vector<fs::path>> parts_of(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return Error{"there is no such bag"};
  if (!fs::is_directory(path, error)) {
    if (!is_part(path)) return Error{"it ends neither in .db3 nor in .mcap, or that with .zstd"};
    return std::vector{path};
  }
  std::vector<fs::path> parts;
  for (const auto& entry : fs::directory_iterator(path, error)) {
    if (is_part(entry.path())) parts.push_back(entry.path());
  }
  if (error) return Error{error.message()};
  if (parts.empty()) return Error{"there is no .db3 or .mcap file in it, nor one with .zstd"};
  std::sort(parts.begin(), parts.end(), is_earlier);
  // ros2 bag play leaves a part that it decompressed beside the compressed one.
  const auto is_same = [](const fs::path& a, const fs::path& b) {
    return uncompressed_name(a) == uncompressed_name(b);
  };
  parts.erase(std::unique(parts.begin(), parts.end(), is_same), parts.end());
  return parts;
}

}  // namespace

bool is_bag(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) || is_part(path);
}

Expected<BagFile> BagFile::open(const fs::path& path, Limits limits) {
  const auto failure = [&](const std::string& why) {
    return Error{"cannot read the bag '" + path.string() + "': " + why};
  };
  auto parts = parts_of(path);
  if (!parts) return failure(parts.error());
  BagFile bag;
  bag.limits_ = limits;
  bag.parts_ = std::move(*parts);
  std::string why;
  while (bag.part_ == nullptr) {
    if (bag.next_part_ == bag.parts_.size()) return failure(why);
    if (const auto opened = bag.open_next_part(); !opened) why = opened.error();
  }
  return bag;
}

Expected<void> BagFile::open_next_part() {
  const fs::path& path = parts_[next_part_++];
  const bool is_mcap = uncompressed_name(path).extension() == ".mcap";
  auto part = is_mcap ? McapFile::open(path, *contents_, limits_.most_memory)
                      : SqliteFile::open(path, *contents_);
  if (part) {
    part_ = std::move(*part);
    return {};
  }
  const std::string why = path.filename().string() + ": " + part.error();
  contents_->lose(why + "; it is left out");
  return Error{why};
}

bool BagFile::next(BagMessage& message) {
  while (next_of_part(message)) {
    if (!is_usable(message)) continue;
    if (message.at < last_) {
      message.at = last_;
      ++out_of_order_;
    }
    last_ = message.at;
    return true;
  }
  return false;
}

bool BagFile::next_of_part(BagMessage& message) {
  while (true) {
    if (part_ != nullptr && part_->next(message)) return true;
    part_.reset();
    if (next_part_ == parts_.size()) return false;
    (void)open_next_part();  // says itself what cannot be opened
  }
}

bool BagFile::is_usable(BagMessage& message) {
  // Times that no recorder writes are damage, with which nobody should calculate.
  constexpr std::int64_t kYear2100 = 4'102'444'800'000'000'000;
  if (message.at < 0 || message.at >= kYear2100) {
    contents_->lose_message("with a time that cannot be");
    return false;
  }
  if (contents_->topics()[message.topic].encoding != "cdr") return true;
  // CDR begins with a zero byte (RTPS 2.3, 10.5), so compressed messages show themselves; that a
  // bag has them stands in its metadata.yaml only, which not every bag still has.
  if (is_zstd(message.bytes)) {
    const Decompressed result =
        decompress_(Compression::kZstd, message.bytes, limits_.most_memory, decompressed_);
    if (result != Decompressed::kWhole) {
      contents_->lose_message(result == Decompressed::kTooLong
                                  ? "that take too much memory when decompressed"
                                  : "whose compression is damaged");
      return false;
    }
    message.bytes = decompressed_;
  } else if (message.bytes.empty() || message.bytes[0] != '\0') {
    contents_->lose_message("neither in CDR nor compressed with zstd: only their times are used");
  }
  return true;
}

}  // namespace culprit::bag
