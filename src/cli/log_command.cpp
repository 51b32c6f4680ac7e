#include <algorithm>
#include <chrono>
#include <cstdio>
#include <deque>
#include <functional>
#include <memory>
#include <thread>

#include <fmt/core.h>

#include "base/live_clock.h"
#include "cli/commands.h"
#include "cli/journal_file.h"
#include "journal/json.h"
#include "json/json.h"
#include "knowledge/event_words.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

struct LogOptions {
  JournalOption journal;
  std::int64_t lines = 50;
  std::string since;
  std::string kind;
  std::string component;
  bool follows = false;
  bool all = false;
  bool json = false;
};

// Whether a value in it is this name. Texts for people do not count.
bool names_it(const Json& document, const std::string& name) {
  if (document.is_string()) return document.get_ref<const std::string&>() == name;
  if (!document.is_structured()) return false;
  return std::any_of(document.begin(), document.end(),
                     [&](const Json& each) { return names_it(each, name); });
}

// A row of culprit's own bookkeeping, or one that repeats another.
bool is_detail(const journal::Entry& entry, const Json& body) {
  namespace kind = journal::kind;
  const std::string type = journal::text_of(body, "type");
  if (entry.kind == kind::kEvent)
    return type == words_of<LifecycleIntended>().name || type == words_of<IncidentChanged>().name;
  if (entry.kind == kind::kOutcome)
    return journal::text_of(body, "outcome") == journal::to_string(Outcome::kDone);
  return entry.kind == kind::kRobot || entry.kind == kind::kCoupling ||
         entry.kind == kind::kLatency;
}

// The row as it is printed; empty: it is not.
std::string line_of(const journal::Entry& entry, const LogOptions& options, std::int64_t earliest) {
  if (entry.at < earliest || (!options.kind.empty() && entry.kind != options.kind)) return "";
  const Json body = parse_json(entry.body);
  if (!options.component.empty() && !names_it(body, options.component)) return "";
  if (options.json) return to_line(log_document(entry));
  const bool shows_details = options.all || !options.kind.empty();
  return !shows_details && is_detail(entry, body) ? "" : log_line(entry);
}

// Calls `look` for each row from `from` on. Gives the number of the row behind them.
Expected<std::int64_t> each_row(const journal::Reader& journal, std::int64_t from,
                                const std::function<void(const journal::Entry&)>& look) {
  auto rows = journal.entries(journal::Which::kReadable, from);
  if (!rows) return Error{rows.error()};
  journal::Entry entry;
  auto more = rows->next(entry);
  for (; more && *more; more = rows->next(entry)) {
    look(entry);
    from = entry.id + 1;
  }
  if (!more) return Error{more.error()};
  return from;
}

// The row from which on as many lines come as are wanted.
Expected<std::int64_t> first_of_latest(const journal::Reader& journal, const LogOptions& options) {
  const auto wanted = static_cast<std::size_t>(options.lines);
  for (std::int64_t count = options.lines;; count *= 4) {
    const auto from = journal.tail(count);
    if (!from) return Error{from.error()};
    std::int64_t read = 0;
    std::deque<std::int64_t> latest;
    const auto end = each_row(journal, *from, [&](const journal::Entry& entry) {
      ++read;
      if (!line_of(entry, options, INT64_MIN).empty()) latest.push_back(entry.id);
      if (latest.size() > wanted) latest.pop_front();
    });
    if (!end) return Error{end.error()};
    if (latest.size() == wanted) return latest.front();
    if (read < count) return *from;  // there are no more
  }
}

int show(const LogOptions& options) {
  std::int64_t earliest = INT64_MIN;
  if (!options.since.empty()) {
    const auto age = duration_of_option("--since", options.since);
    if (!age) return fail(age.error(), kUsage);
    earliest = wall_now() - age->count();
  }
  const auto journal = options.journal.open();
  if (!journal) return fail(journal.error());
  const bool is_bounded =
      options.since.empty() && options.kind.empty() && options.component.empty();
  auto from = is_bounded ? first_of_latest(*journal, options) : Expected<std::int64_t>(1);
  if (!from) return fail(from.error());
  for (;;) {
    constexpr auto kPeriod = std::chrono::milliseconds(300);
    from = each_row(*journal, *from, [&](const journal::Entry& entry) {
      const std::string line = line_of(entry, options, earliest);
      if (!line.empty()) fmt::print("{}\n", line);
    });
    if (!from) return fail(from.error());
    if (!options.follows) return kOk;
    std::fflush(stdout);
    if (std::ferror(stdout) != 0) return kFailed;  // nobody reads it
    std::this_thread::sleep_for(kPeriod);
  }
}

}  // namespace

void add_log(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<LogOptions>();
  CLI::App* command = app.add_subcommand("log", "Show culprit's findings, decisions and actions");
  options->journal.add_to(*command);
  command->add_option("-n,--lines", options->lines, "Number of the latest rows")
      ->check(CLI::Range(1, 1'000'000'000))
      ->capture_default_str();
  command->add_option("--since", options->since, "Only rows of the last 10min, 2h, 1d ...")
      ->type_name("DURATION");
  command
      ->add_option("--kind", options->kind, "Only rows of this kind, without the limit of --lines")
      ->check(CLI::IsMember({"session", "robot", "event", "intent", "outcome", "belief", "coupling",
                             "latency", "gap", "end"}));
  command
      ->add_option("--component", options->component,
                   "Only rows that name this component, without the limit of --lines")
      ->type_name("COMPONENT");
  command->add_flag("--all", options->all,
                    "Also details: answers to requests, changes of incidents, internal records");
  command->add_flag("-f,--follow", options->follows, "Go on with new rows until Ctrl-C");
  command->add_flag("--json", options->json, "One JSON document per row");
  command->callback([options, &exit_code] { exit_code = show(*options); });
}

}  // namespace culprit::cli
