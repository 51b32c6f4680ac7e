// Follows a journal from the newest run that the outbox knows, and keeps in the outbox what it
// amounts to.
#pragma once

#include <atomic>
#include <filesystem>

#include "fleet/definition.h"
#include "fleet/outbox.h"
#include "fleet/tally.h"
#include "journal/reader.h"

namespace culprit::fleet {

class JournalTail {
 public:
  explicit JournalTail(std::filesystem::path journal) : journal_(std::move(journal)) {}

  // Takes what is new, and leaves off early if `stop` is set. After an error the run is read from
  // its beginning. Errors: the journal cannot be read, or the outbox not be written.
  Expected<void> follow(Outbox& outbox, const std::atomic<bool>& stop);

  // The run under way; nothing: none yet.
  const std::optional<Run>& run() const { return tally_.run(); }

 private:
  Expected<void> begin(const journal::Reader& reader, const Outbox& outbox);
  Expected<void> read(const journal::Reader& reader, Outbox& outbox, const std::atomic<bool>& stop);
  Expected<void> keep(Outbox& outbox);

  std::filesystem::path journal_;
  Tally tally_;
  std::map<StrategyName, std::string> definitions_;  // of the run
  std::map<StrategyName, Counts> kept_;
};

}  // namespace culprit::fleet
