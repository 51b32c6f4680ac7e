#include "replay/recording.h"

namespace culprit::replay {

using journal::Entry;

Recording::Recording(const journal::Reader& journal) : journal_(&journal) {}

Expected<Recording> Recording::open(const journal::Reader& journal, std::int64_t session) {
  const auto row = session == 0 ? journal.newest(journal::kind::kSession) : journal.entry(session);
  if (!row) return Error{row.error()};
  if (!*row || (*row)->kind != journal::kind::kSession)
    return Error{session == 0
                     ? "it has no run that begins in it"
                     : "row " + std::to_string(session) + " is not the beginning of a run"};
  auto begin = journal::session_from_json(parse_json((*row)->body));
  if (!begin) return Error{begin.error()};
  if (begin->continued)
    return Error{"the run of row " + std::to_string((*row)->id) +
                 " began in another file, which was removed or damaged"};
  Recording recording(journal);
  recording.session_row_ = (*row)->id;
  recording.session_ = std::move(*begin);
  Checked checked = check(Source(recording.session_.rules_path, recording.session_.rules_text));
  if (!checked.rules)
    return Error{"the rules of the run that begins with row " + std::to_string((*row)->id) +
                 " are not valid for this culprit"};
  recording.rules_ = std::make_unique<const RuleSet>(std::move(*checked.rules));
  if (const auto ready = recording.rewind(); !ready) return Error{ready.error()};
  return recording;
}

Expected<void> Recording::rewind() {
  auto rows = journal_->entries(journal::Which::kAll, session_row_ + 1);
  if (!rows) return Error{rows.error()};
  rows_ = std::move(*rows);
  steps_.reset();
  has_gap_ = false;
  return {};
}

Expected<bool> Recording::next(journal::Step& step) {
  while (true) {
    if (steps_) {
      const auto read = steps_->next(step);
      if (!read) return Error{"row " + std::to_string(entry_->id) + ": " + read.error()};
      if (*read) return true;
      steps_.reset();
    }
    const auto row = rows_->next(*entry_);
    if (!row) return Error{row.error()};
    if (!*row || entry_->kind == journal::kind::kSession) return false;
    has_gap_ |= entry_->kind == journal::kind::kGap;
    if (entry_->kind == journal::kind::kSteps) steps_.emplace(entry_->body, *rules_);
  }
}

}  // namespace culprit::replay
