#include "drill/drill_record.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

#include "base/text_file.h"
#include "journal/json.h"

namespace culprit::drill {
namespace {

constexpr const char* kHead = "drill.json";
constexpr const char* kTrials = "trials.jsonl";

std::vector<std::string> texts_in(const Json& list) {
  std::vector<std::string> texts;
  for (const Json& each : list)
    if (each.is_string()) texts.push_back(each.get<std::string>());
  return texts;
}

Expected<void> append(const std::filesystem::path& path, const std::string& line) {
  const auto failure = [&] {
    return Error{"cannot write '" + path.string() + "': " + std::strerror(errno)};
  };
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (file < 0) return failure();
  // A line that was cut before stays alone.
  const off_t size = lseek(file, 0, SEEK_END);
  char last = '\n';
  const bool is_cut = size > 0 && pread(file, &last, 1, size - 1) == 1 && last != '\n';
  const std::string text = (is_cut ? "\n" : "") + line + "\n";
  errno = ENOSPC;  // of a write that is cut short, which sets none
  const bool is_written =
      write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
      fsync(file) == 0;
  const auto failed = is_written ? Expected<void>() : Expected<void>(failure());
  close(file);
  return failed;
}

}  // namespace

std::vector<Trial> trials_in(const std::string& text) {
  std::vector<Trial> trials;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    if (auto trial = trial_from(parse_strict_json(text.substr(from, end - from))))
      trials.push_back(std::move(*trial));
    from = end + 1;
  }
  return trials;
}

Expected<DrillRecord> DrillRecord::open(const std::filesystem::path& folder,
                                        const DrillHead& head) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error{"cannot make '" + folder.string() + "': " + error.message()};
  DrillRecord record(folder, head);
  if (!std::filesystem::exists(record.file(kHead), error)) {
    if (auto written = record.write_head(); !written) return Error{written.error()};
    return record;
  }
  const auto text = read_text(record.file(kHead).string());
  if (!text) return Error{text.error()};
  const Json known = parse_json(*text);
  if (!known.is_object() || journal::text_of(known, "rules") != head.rules ||
      !known.contains("plan") || texts_in(known["plan"]) != head.plan)
    return Error{"'" + folder.string() +
                 "' holds a drill of other rules or another plan; choose another --record"};
  if (known.contains("healthy")) record.head_.healthy = healthy_from(known["healthy"]);
  if (std::filesystem::exists(record.file(kTrials), error)) {
    const auto trials = read_text(record.file(kTrials).string());
    if (!trials) return Error{trials.error()};
    record.trials_ = trials_in(*trials);
  }
  return record;
}

bool DrillRecord::has(const std::string& id) const {
  return std::ranges::any_of(
      trials_, [&](const Trial& each) { return each.id() == id && each.trouble.empty(); });
}

Expected<void> DrillRecord::write_head() const {
  const Json json{{"format", "culprit-drill"},
                  {"plan", head_.plan},
                  {"healthy", to_json(head_.healthy)},
                  {"rules", head_.rules}};
  return write_text(file(kHead).string(), to_indented(json) + "\n");
}

Expected<void> DrillRecord::keep(HealthyRobot healthy) {
  head_.healthy = std::move(healthy);
  return write_head();
}

Expected<void> DrillRecord::add(const Trial& trial) {
  if (auto added = append(file(kTrials), to_line(to_json(trial))); !added) return added;
  trials_.push_back(trial);
  return {};
}

}  // namespace culprit::drill
