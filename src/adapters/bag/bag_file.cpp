#include "bag/bag_file.h"

#include <algorithm>

#include "bag/mcap_file.h"
#include "bag/sqlite_file.h"

namespace culprit::bag {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostKeptOpen = 64;  // files, of which a process may have 1,024

std::int64_t usual_gap(const TimeLine& line) {
  constexpr std::int64_t kUnknown = 1'000'000;
  if (line.messages < 2) return kUnknown;
  const std::int64_t gap = (line.last - line.first) / static_cast<std::int64_t>(line.messages - 1);
  return std::clamp(gap, kUnknown, PieceFinder::kSlack);
}

// Whether all of `part` is so long before `begin` that no file of another order explains it.
bool is_set_back(const TimeLine& part, std::int64_t begin) {
  constexpr std::int64_t kUsualGaps = 10;
  return begin - part.last > std::max(PieceFinder::kSlack, kUsualGaps * usual_gap(part));
}

}  // namespace

bool is_bag(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) || has_name_of_bag(path);
}

Expected<BagFile> BagFile::open(const fs::path& path, Limits limits) {
  return open(std::span(&path, 1), limits);
}

Expected<BagFile> BagFile::open(std::span<const fs::path> paths, Limits limits) {
  BagFile bag;
  bag.limits_ = limits;
  bag.expected_count_ = 0;
  for (const fs::path& path : paths) {
    if (const auto added = bag.add(path); !added)
      return Error{"cannot read the bag '" + path.string() + "': " + added.error()};
  }
  std::stable_sort(bag.parts_.begin(), bag.parts_.end(),
                   [](const Open& a, const Open& b) { return a.line.first < b.line.first; });
  if (paths.size() > 1) bag.straighten_parts(bag.parts_, false);
  for (const Open& each : bag.parts_) {
    for (const TimeLine::Jump& jump : each.line.jumps)
      bag.contents_->note_jump({jump.at, jump.by, jump.recorded_at});
  }
  return bag;
}

Expected<std::unique_ptr<Storage>> BagFile::open_part(const BagPart& part) {
  if (const std::string why = why_no_part(part.path); !why.empty()) return Error{why};
  return part.format == PartFormat::kMcap
             ? McapFile::open(part.path, *contents_, limits_.most_memory)
             : SqliteFile::open(part.path, *contents_);
}

// One recording.
Expected<void> BagFile::add(const fs::path& path) {
  auto found = find_parts(path);
  if (!found) return Error{found.error()};
  for (std::string& each : found->missing) contents_->lose(std::move(each));
  for (std::string& each : found->foreign) contents_->remark(std::move(each));
  std::vector<Open> recording;
  std::string why;
  bool is_after_lost = false;
  for (BagPart& part : found->parts) {
    auto storage = open_part(part);
    if (!storage) {
      why = part.path.filename().string() + ": " + storage.error();
      contents_->lose(why + "; it is left out");
      is_after_lost = true;
      continue;
    }
    PieceFinder finder;
    (*storage)->survey(finder);
    late_ += finder.late();
    part.is_after_missing |= is_after_lost;
    is_after_lost = false;
    Open open{std::move(part), straighten(finder.pieces()), std::move(*storage)};
    if (recording.size() + parts_.size() >= kMostKeptOpen) open.storage.reset();
    recording.push_back(std::move(open));
  }
  if (recording.empty()) return Error{why};
  for (BagTopic& each : found->topics) contents_->place_of(std::move(each));
  const bool is_whole = found->missing.empty() && found->messages;
  expected_count_ = is_whole && expected_count_ ? std::optional(*expected_count_ + *found->messages)
                                                : std::nullopt;
  if (!found->is_ordered)
    std::stable_sort(recording.begin(), recording.end(),
                     [](const Open& a, const Open& b) { return a.line.first < b.line.first; });
  straighten_parts(recording, found->is_ordered);
  for (Open& each : recording) parts_.push_back(std::move(each));
  return {};
}

// The clock may have been set at the end of a part, too. Parts that overlap were recorded at the same
// time.
void BagFile::straighten_parts(std::vector<Open>& recording, bool is_ordered) {
  std::int64_t begin = 0;
  std::int64_t end = 0;
  std::int64_t carried = 0;
  bool is_first = true;
  for (Open& each : recording) {
    TimeLine& line = each.line;
    if (line.stretches.empty()) continue;
    const std::int64_t as_before = line.first + carried;
    const bool continues =
        carried != 0 && as_before >= end - PieceFinder::kSlack && as_before <= end + kLongestHole;
    if (continues) {
      line.move(carried);
    } else if (!is_first) {
      const bool is_forward = line.first > end + kLongestHole && !each.part.is_after_missing;
      const bool is_backward = is_ordered && line.last < begin && is_set_back(line, begin);
      if (is_forward || is_backward) {
        const std::int64_t by = line.first - end - usual_gap(line);
        const std::int64_t recorded_at = line.first - line.stretches.front().offset;
        line.move(-by);
        line.jumps.insert(line.jumps.begin(), {line.first, by, recorded_at});
      }
    }
    carried = line.stretches.back().offset;
    begin = is_first ? line.first : std::min(begin, line.first);
    end = is_first ? line.last : std::max(end, line.last);
    is_first = false;
  }
}

std::vector<BagFile::Part> BagFile::parts() const {
  std::vector<Part> all;
  for (const Open& each : parts_) {
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(each.part.path, error);
    all.push_back(
        {each.part.path, each.part.format, error ? 0 : bytes, each.line.first, each.line.last});
  }
  return all;
}

std::uint64_t BagFile::late() const {
  std::uint64_t late = late_;
  for (const Open& each : parts_) late += each.storage != nullptr ? each.storage->late() : 0;
  return late;
}

bool BagFile::next(BagMessage& message) {
  while (next_of_parts(message)) {
    ++count_;
    is_after_hole_ |= message.is_after_hole;
    if (!is_usable(message)) continue;
    message.is_after_hole = is_after_hole_;
    is_after_hole_ = false;
    if (message.at < last_) {
      message.at = last_;
      ++out_of_order_;
    }
    last_ = message.at;
    return true;
  }
  count_what_is_missing();
  return false;
}

void BagFile::count_what_is_missing() {
  if (expected_count_ && count_ < *expected_count_ && contents_->losses().empty())
    contents_->lose("metadata.yaml counts " + std::to_string(*expected_count_) +
                    " messages, of which " + std::to_string(*expected_count_ - count_) +
                    " are missing");
  expected_count_.reset();
}

bool BagFile::next_of_parts(BagMessage& message) {
  if (given_ != nullptr) take_head(*given_);
  given_ = nullptr;
  while (true) {
    for (std::size_t p = 0; p < next_part_; ++p) {
      Open& each = parts_[p];
      if (each.has_head && (given_ == nullptr || each.head.at < given_->head.at)) given_ = &each;
    }
    const bool is_due = next_part_ < parts_.size() &&
                        (given_ == nullptr || parts_[next_part_].line.first <= given_->head.at);
    if (!is_due) break;
    begin(parts_[next_part_++]);
    given_ = nullptr;
  }
  if (given_ == nullptr) return false;
  message = given_->head;
  return true;
}

void BagFile::begin(Open& part) {
  if (part.storage == nullptr) {
    auto storage = open_part(part.part);
    if (!storage)
      return contents_->lose(part.part.path.filename().string() + ": " + storage.error());
    part.storage = std::move(*storage);
    PieceFinder ignored;
    part.storage->survey(ignored);
  }
  part.storage->follow(part.line);
  take_head(part);
  part.head.is_after_hole |= part.part.is_after_missing;
}

void BagFile::take_head(Open& part) {
  part.has_head = part.storage->next(part.head);
  if (part.has_head) return;
  late_ += part.storage->late();
  part.storage.reset();
}

bool BagFile::is_usable(BagMessage& message) {
  if (!is_time(message.recorded_at)) {  // with which nobody should calculate
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
  } else if (message.bytes.empty()) {
    contents_->lose_message("without content: only their times are used");
  } else if (message.bytes[0] != '\0') {
    contents_->lose_message("neither in CDR nor compressed with zstd: only their times are used");
  }
  return true;
}

}  // namespace culprit::bag
