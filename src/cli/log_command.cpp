#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>

#include <fmt/core.h>

#include "base/live_clock.h"
#include "cli/commands.h"
#include "cli/journal_file.h"
#include "json/json.h"
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
  bool json = false;
};

// Whether a value in it is this name. Texts for people do not count.
bool names_it(const Json& document, const std::string& name) {
  if (document.is_string()) return document.get_ref<const std::string&>() == name;
  if (!document.is_structured()) return false;
  return std::any_of(document.begin(), document.end(),
                     [&](const Json& each) { return names_it(each, name); });
}

void print_row(const journal::Entry& entry, const LogOptions& options, std::int64_t earliest) {
  if (entry.at < earliest || (!options.kind.empty() && entry.kind != options.kind)) return;
  if (!options.component.empty() && !names_it(parse_json(entry.body), options.component)) return;
  const std::string line = options.json ? to_line(log_document(entry)) : log_line(entry);
  if (!line.empty()) fmt::print("{}\n", line);
}

// Prints the rows from `from` on. Gives the number of the row behind them.
Expected<std::int64_t> print_rows(const journal::Reader& journal, std::int64_t from,
                                  const LogOptions& options, std::int64_t earliest) {
  auto rows = journal.entries(journal::Which::kReadable, from);
  if (!rows) return Error{rows.error()};
  journal::Entry entry;
  auto more = rows->next(entry);
  for (; more && *more; more = rows->next(entry)) {
    print_row(entry, options, earliest);
    from = entry.id + 1;
  }
  if (!more) return Error{more.error()};
  return from;
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
  auto from = is_bounded ? journal->tail(options.lines) : Expected<std::int64_t>(1);
  if (!from) return fail(from.error());
  for (;;) {
    constexpr auto kPeriod = std::chrono::milliseconds(300);
    from = print_rows(*journal, *from, options, earliest);
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
  command->add_flag("-f,--follow", options->follows, "Go on with new rows until Ctrl-C");
  command->add_flag("--json", options->json, "One JSON document per row");
  command->callback([options, &exit_code] { exit_code = show(*options); });
}

}  // namespace culprit::cli
