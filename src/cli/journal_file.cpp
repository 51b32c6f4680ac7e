#include "cli/journal_file.h"

#include <algorithm>
#include <ctime>

#include <fmt/core.h>

#include "base/environment.h"
#include "base/name_grammar.h"
#include "cli/commands.h"
#include "journal/json.h"
#include "knowledge/describe.h"
#include "terminal/console.h"

namespace culprit::cli {

namespace fs = std::filesystem;

void JournalOption::add_to(CLI::App& command) {
  command
      .add_option("--journal", path,
                  "The journal file (default: the only one in ~/.local/state/culprit)")
      ->type_name("FILE");
}

Expected<fs::path> JournalOption::file() const {
  if (!path.empty()) return fs::path(path);
  const fs::path folder = default_state_folder();
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".journal") found.push_back(entry.path());
  }
  if (found.size() == 1) return found.front();
  if (found.empty())
    return Error{"there is no journal in '" + folder.string() +
                 "': culprit run writes one; name another with --journal"};
  std::sort(found.begin(), found.end());
  std::string names;
  for (const fs::path& each : found) names += "\n  --journal " + each.string();
  return Error{"there is more than one journal; name one:" + names};
}

Expected<journal::Reader> JournalOption::open() const {
  const auto name = file();
  if (!name) return Error{name.error()};
  return journal::Reader::open(*name);
}

namespace {

// `split`: gmtime_r or localtime_r. `middle`, `end`: what stands between date and time, and behind.
std::string written(std::int64_t at, std::tm* (*split)(const std::time_t*, std::tm*), char middle,
                    const char* end) {
  const std::int64_t milliseconds = at / 1'000'000;
  const auto seconds = static_cast<std::time_t>(milliseconds / 1000);
  std::tm parts{};
  if (at < 0 || split(&seconds, &parts) == nullptr) return "?";
  return fmt::format("{:04}-{:02}-{:02}{}{:02}:{:02}:{:02}.{:03}{}", parts.tm_year + 1900,
                     parts.tm_mon + 1, parts.tm_mday, middle, parts.tm_hour, parts.tm_min,
                     parts.tm_sec, milliseconds % 1000, end);
}

}  // namespace

std::string local_time(std::int64_t at) { return written(at, localtime_r, ' ', ""); }

std::string utc_time(std::int64_t at) { return written(at, gmtime_r, 'T', "Z"); }

Json log_document(const journal::Entry& entry) {
  return {{"id", entry.id},
          {"at", utc_time(entry.at)},
          {"kind", entry.kind},
          {"body", parse_json(entry.body)}};
}

std::string log_line(const journal::Entry& entry) {
  const Json body = parse_json(entry.body);
  std::string what = entry.kind;
  if (entry.kind == journal::kind::kEvent) {
    what = journal::text_of(body, "type");
    std::replace(what.begin(), what.end(), '_', ' ');
  }
  std::string text = journal::text_of(body, "text");
  if (text.empty() && body.contains("alpha")) {
    const Belief belief{journal::number_of(body, "alpha"), journal::number_of(body, "beta")};
    text = fmt::format("{} of {}: success rate {}", journal::text_of(body, "strategy"),
                       journal::text_of(body, "rule"), to_string(belief.mean()));
  }
  if (text.empty() && body.contains("cause"))
    text = fmt::format("{} with {}: cleared {:g} times, stayed {:g} times",
                       journal::text_of(body, "effect"), journal::text_of(body, "cause"),
                       journal::number_of(body, "cleared"), journal::number_of(body, "stayed"));
  if (text.empty() && body.contains("least_s"))
    text = fmt::format("{}: seen {:g} times, {:.2f} to {:.2f} s", journal::text_of(body, "rule"),
                       journal::number_of(body, "count"), journal::number_of(body, "least_s"),
                       journal::number_of(body, "most_s"));
  if (text.empty() && body.contains("incident")) {
    const std::string how = journal::text_of(body, "how");
    text = fmt::format("{}: {}", journal::text_of(body, "incident"),
                       how.empty() ? journal::text_of(body, "headline") : how);
  }
  if (text.empty() && body.contains("lifecycle"))
    text = fmt::format("{} is to be {}", journal::text_of(body, "component"),
                       journal::text_of(body, "lifecycle"));
  if (text.empty() && entry.kind == journal::kind::kEvent) return "";
  // culprit's own rows are escaped; the file may be another's.
  return fmt::format("{:>7}  {}  {:<18}  {}", entry.id, local_time(entry.at), escape_controls(what),
                     escape_controls(text));
}

}  // namespace culprit::cli
