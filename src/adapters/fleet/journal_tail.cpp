#include "fleet/journal_tail.h"

#include "language/checker.h"

namespace culprit::fleet {
namespace {

// Rows whose failures are held in memory: a run may have months of them.
constexpr int kMostHeld = 10'000;

// Whether the run that began with this row is in this file: it may have taken another's place.
Expected<bool> has_run(const journal::Reader& reader, std::int64_t row, const std::string& run) {
  auto rows = reader.entries(journal::Which::kReadable, row);
  if (!rows) return Error{rows.error()};
  journal::Entry entry;
  const auto more = rows->next(entry);
  if (!more) return Error{more.error()};
  if (!*more || entry.id != row || !Tally::begins_run(entry)) return false;
  Tally first;
  first.take(entry, rows->hash());
  return first.run()->id == run;
}

// An improvised strategy has none.
std::map<StrategyName, std::string> definitions_in(const std::string& rules_text) {
  const Checked checked = check(Source("rules", rules_text));
  return checked.rules ? definitions_of(*checked.rules) : std::map<StrategyName, std::string>();
}

}  // namespace

Expected<void> JournalTail::follow(Outbox& outbox, const std::atomic<bool>& stop) {
  std::error_code error;
  if (!std::filesystem::exists(journal_, error)) return {};  // not yet
  const auto reader = journal::Reader::open(journal_);
  if (!reader) return Error{reader.error()};
  const auto done = read(*reader, outbox, stop);
  if (!done) tally_ = {};
  return done;
}

// From the beginning of the newest run that is known, for what was counted of it is not known any
// more. In another file, from its beginning: earlier outcomes count once.
Expected<void> JournalTail::begin(const journal::Reader& reader, const Outbox& outbox) {
  tally_ = {};
  kept_.clear();
  const auto newest = outbox.newest_run();
  if (!newest) return Error{newest.error()};
  const auto is_there = has_run(reader, newest->row, newest->run);
  if (!is_there) return Error{is_there.error()};
  tally_.begin_at(*is_there ? newest->row : 1);
  return {};
}

Expected<void> JournalTail::read(const journal::Reader& reader, Outbox& outbox,
                                 const std::atomic<bool>& stop) {
  auto is_there = Expected<bool>(false);
  if (const auto& run = tally_.run()) is_there = has_run(reader, run->row, run->id);
  if (!is_there) return Error{is_there.error()};
  if (!*is_there) {
    if (const auto begun = begin(reader, outbox); !begun) return begun;
  }
  auto rows = reader.entries(journal::Which::kReadable, tally_.next_row());
  if (!rows) return Error{rows.error()};
  journal::Entry entry;
  int held = 0;
  auto more = rows->next(entry);
  for (; more && *more; more = rows->next(entry)) {
    if (stop) return {};
    if (Tally::begins_run(entry) || ++held == kMostHeld) {
      if (const auto kept = keep(outbox); !kept) return kept;
      held = 0;
    }
    if (Tally::begins_run(entry)) kept_.clear();
    tally_.take(entry, rows->hash());
    if (Tally::begins_run(entry)) definitions_ = definitions_in(tally_.rules_text());
  }
  if (!more) return Error{more.error()};
  return keep(outbox);
}

Expected<void> JournalTail::keep(Outbox& outbox) {
  if (!tally_.run()) return {};
  const std::vector<Failure> failures = tally_.take_failures();
  const auto newest = outbox.newest_run();
  if (!newest) return Error{newest.error()};
  if (failures.empty() && tally_.counts() == kept_ && newest->run == tally_.run()->id) return {};
  const auto done = outbox.keep(*tally_.run(), tally_.counts(), definitions_, failures);
  if (done) kept_ = tally_.counts();
  return done;
}

}  // namespace culprit::fleet
