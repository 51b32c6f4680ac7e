#include "recorder/recording_folder.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <sys/statvfs.h>

#include "base/units.h"

namespace culprit::recorder {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExtension = ".mcap";
constexpr std::int64_t kMillisecond = 1'000'000;

std::string fit_for_name(const std::string& text) {
  constexpr std::size_t kMost = 60;
  std::string out;
  for (const char c : text.substr(0, kMost)) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '-' || c == '.';
    out += is_plain ? c : '-';
  }
  // A name that begins with a point is hidden.
  if (out.empty() || out.front() == '.') out.insert(out.begin(), '-');
  return out;
}

std::string megabytes(std::uint64_t bytes) { return std::to_string(bytes / 1'000'000) + " MB"; }

}  // namespace

std::string recording_name(const std::string& robot, std::int64_t when, const std::string& why) {
  using namespace std::chrono;
  const sys_time<milliseconds> at{milliseconds(when / kMillisecond)};
  const auto day = floor<days>(at);
  const year_month_day date(day);
  const hh_mm_ss time(at - day);
  char text[64];
  std::snprintf(text, sizeof text, "%04d%02u%02uT%02d%02d%02d.%03dZ", int(date.year()),
                unsigned(date.month()), unsigned(date.day()), int(time.hours().count()),
                int(time.minutes().count()), int(time.seconds().count()),
                int(time.subseconds().count()));
  return fit_for_name(robot) + "_" + text + "_" + fit_for_name(why) + std::string(kExtension);
}

std::optional<std::int64_t> when_recorded(const std::string& name) {
  using namespace std::chrono;
  if (!name.ends_with(kExtension)) return std::nullopt;
  const std::size_t first = name.find('_');
  const std::size_t second = name.find('_', first == std::string::npos ? first : first + 1);
  if (second == std::string::npos) return std::nullopt;
  const std::string when = name.substr(first + 1, second - first - 1);
  int y = 0, mo = 0, d = 0, h = 0, mi = 0, s = 0, ms = 0, end = 0;
  constexpr std::size_t kSize = std::string_view("20261125T190317.042Z").size();
  if (when.size() != kSize ||
      std::sscanf(when.c_str(), "%4d%2d%2dT%2d%2d%2d.%3dZ%n", &y, &mo, &d, &h, &mi, &s, &ms,
                  &end) != 7 ||
      end != int(kSize))
    return std::nullopt;
  const year_month_day date(year{y}, month(unsigned(mo)), day(unsigned(d)));
  if (!date.ok()) return std::nullopt;
  const auto at =
      sys_days(date) + hours(h) + minutes(mi) + std::chrono::seconds(s) + milliseconds(ms);
  return nanoseconds(at.time_since_epoch()).count();
}

std::vector<StoredRecording> recordings_in(const fs::path& folder) {
  std::vector<StoredRecording> all;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto when = when_recorded(entry->path().filename());
    std::error_code gone;
    if (!when || !fs::is_regular_file(entry->symlink_status(gone))) continue;
    const std::uint64_t bytes = entry->file_size(gone);
    const auto written = std::chrono::file_clock::to_sys(entry->last_write_time(gone));
    if (!gone)
      all.push_back({entry->path(), *when,
                     std::chrono::nanoseconds(written.time_since_epoch()).count(), bytes});
  }
  std::ranges::sort(all, {}, [](const StoredRecording& r) { return std::pair(r.when, r.path); });
  return all;
}

Expected<RecordingFolder::Space> RecordingFolder::space_of(const fs::path& folder) {
  struct statvfs about {};
  if (statvfs(folder.c_str(), &about) != 0) return Error{std::strerror(errno)};
  return Space{std::uint64_t{about.f_blocks} * about.f_frsize,
               std::uint64_t{about.f_bavail} * about.f_frsize};
}

std::uint64_t RecordingFolder::left_free(const Space& space) {
  return std::min(kLeftFree, space.total / 10);
}

Expected<void> RecordingFolder::open() const {
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) return Error{"the folder " + path_.string() + " cannot be made: " + error.message()};
  return {};
}

Expected<void> RecordingFolder::make_room(std::uint64_t bytes, const fs::path& own) const {
  const std::vector<StoredRecording> all = recordings_in(path_);
  std::uint64_t used = 0;
  for (const StoredRecording& each : all) used += each.bytes;
  auto oldest = all.begin();
  while (true) {
    const auto space = space_(path_);
    if (!space) return Error{"the folder " + path_.string() + ": " + space.error()};
    const bool is_in_budget = used + bytes <= most_bytes_;
    const bool is_on_disk = space->free >= left_free(*space) + bytes;
    if (is_in_budget && is_on_disk) return {};
    while (oldest != all.end() && oldest->path == own) ++oldest;
    if (oldest == all.end())
      return Error{is_in_budget
                       ? "the disk of " + path_.string() + " has " + megabytes(space->free) +
                             " left, of which " + megabytes(left_free(*space)) + " stay free"
                       : "one recording alone would have more than the " + megabytes(most_bytes_) +
                             " of all (--record-disk)"};
    std::error_code error;
    fs::remove(oldest->path, error);
    if (error)
      return Error{oldest->path.string() + " cannot be removed to make room: " + error.message()};
    used -= oldest->bytes;
    ++oldest;
  }
}

}  // namespace culprit::recorder
