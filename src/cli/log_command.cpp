#include <memory>

#include <fmt/core.h>

#include "base/live_clock.h"
#include "cli/commands.h"
#include "cli/journal_file.h"
#include "json/json.h"

namespace culprit::cli {
namespace {

struct LogOptions {
  JournalOption journal;
  std::int64_t lines = 50;
  std::string since;
  std::string kind;
  bool json = false;
};

int show(const LogOptions& options) {
  std::int64_t earliest = INT64_MIN;
  if (!options.since.empty()) {
    const auto age = parse_duration(options.since);
    if (!age) return fail("--since: " + age.error()), kUsage;
    earliest = wall_now() - age->count();
  }
  const auto journal = options.journal.open();
  if (!journal) return fail(journal.error());
  const bool is_bounded = options.since.empty() && options.kind.empty();
  const auto from = is_bounded ? journal->tail(options.lines) : Expected<std::int64_t>(1);
  if (!from) return fail(from.error());
  auto rows = journal->entries(journal::Which::kReadable, *from);
  if (!rows) return fail(rows.error());
  journal::Entry entry;
  auto more = rows->next(entry);
  for (; more && *more; more = rows->next(entry)) {
    if (entry.at < earliest || (!options.kind.empty() && entry.kind != options.kind)) continue;
    if (options.json) {
      fmt::print("{}\n", to_line(log_document(entry)));
    } else {
      fmt::print("{}\n", log_line(entry));
    }
  }
  return more ? kOk : fail(more.error());
}

}  // namespace

void add_log(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<LogOptions>();
  CLI::App* command = app.add_subcommand("log", "Show culprit's findings, decisions and actions");
  options->journal.add_to(*command);
  command->add_option("-n,--lines", options->lines, "How many of the latest rows")
      ->check(CLI::Range(1, 1'000'000'000))
      ->capture_default_str();
  command->add_option("--since", options->since, "Only rows of this past time: 10min, 2h");
  command->add_option("--kind", options->kind, "All rows of this kind only")
      ->check(CLI::IsMember({"session", "robot", "event", "intent", "outcome", "belief", "coupling",
                             "latency", "gap", "end"}));
  command->add_flag("--json", options->json, "One JSON document per row");
  command->callback([options, &exit_code] { exit_code = show(*options); });
}

}  // namespace culprit::cli
