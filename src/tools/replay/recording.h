// One run of culprit as its journal has it: the rules and settings of the manager, and each step in
// order.
#pragma once

#include <memory>

#include "journal/reader.h"
#include "journal/session.h"
#include "journal/step_codec.h"
#include "language/checker.h"

namespace culprit::replay {

class Recording {
 public:
  // The run that begins with row `session`; the newest run of the file if that is 0. `journal` must
  // outlive the recording. Errors: there is none, or it cannot be read.
  static Expected<Recording> open(const journal::Reader& journal, std::int64_t session = 0);

  const journal::Session& session() const { return session_; }
  std::int64_t session_row() const { return session_row_; }
  // At an address that stays.
  const RuleSet& rules() const { return *rules_; }

  // From the beginning, or anew.
  Expected<void> rewind();
  // False at the end of the run. Errors name the row.
  Expected<bool> next(journal::Step& step);
  // The row that the last step is in.
  std::int64_t row() const { return entry_->id; }

  // Rows that a `gap` says were lost since rewind(): the replay need not be exact then.
  bool has_gap() const { return has_gap_; }

 private:
  explicit Recording(const journal::Reader& journal);

  const journal::Reader* journal_;
  journal::Session session_;
  std::int64_t session_row_ = 0;
  std::unique_ptr<const RuleSet> rules_;
  std::optional<journal::Cursor> rows_;
  std::unique_ptr<journal::Entry> entry_ = std::make_unique<journal::Entry>();
  std::optional<journal::StepReader> steps_;
  bool has_gap_ = false;
};

}  // namespace culprit::replay
