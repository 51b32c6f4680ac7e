// The journal of a live run: what the last run left behind, and the recording of this one.
#pragma once

#include "journal/recorder.h"
#include "journal/recovery.h"
#include "journal/session.h"

namespace culprit::cli {

// What is known when a run begins.
struct RunBeginning {
  std::optional<journal::Writer> writer;  // nothing: it cannot be written now
  journal::Learned learned;
  journal::Json interrupted = journal::Json::array();
  Past past;
  bool is_paused = false;
  bool is_dry_run = false;
  std::vector<std::string> findings;  // for the user, one line each
};

// Opens the journal, or reads it if it cannot be written, and finds out what the last run left
// behind. Nothing that is wrong with a journal keeps culprit from managing the robot.
RunBeginning begin_journal(const std::filesystem::path& path, const RuleSet& rules,
                           const journal::Moment& now);

}  // namespace culprit::cli
