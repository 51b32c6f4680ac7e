// The results that the fleet's database has not received yet, and this robot's identity in the
// fleet: a small SQLite file beside the journal, "a.journal-fleet". The journal's own rows go after
// a month; rows here stay until the database has them.
//
// It does not count: the sums of a run replace its former sums (tally.h). So it may be written as
// often as one likes, and lost: it is made anew as far back as the journal goes, and only the
// robot's number changes.
//
// It is bounded: beyond kMostFailures and kMostCounts the oldest rows go, and among those the sent
// ones first. The number of unsent rows that went is kept and reported.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "fleet/tally.h"
#include "journal/database.h"

namespace culprit::fleet {

struct Identity {
  std::string robot;  // made once: 32 hexadecimal digits
  std::string
      before;  // that this one was until its journal turned up on another computer; or empty
  std::string machine;  // a hash of the computer's id and `robot`; empty: it has none
  bool is_new = false;
  bool is_copy = false;  // the journal came from another computer since it was opened last
};

struct Outcome {
  std::string run;
  StrategyName name;
  std::string definition;  // of the strategy (definition.h); empty: the rules do not have it
  Counts counts;
};

// A failure of one run.
struct RunFailure {
  std::string run;
  Failure failure;
};

struct Waiting {
  std::vector<Run> runs;  // of the others
  std::vector<Outcome> outcomes;
  std::vector<RunFailure> failures;
  bool empty() const { return outcomes.empty() && failures.empty(); }
};

class Outbox {
 public:
  static constexpr std::int64_t kMostFailures = 20'000;
  static constexpr std::int64_t kMostCounts = 50'000;

  // Makes the file if it is not there; a damaged one is set aside, and reported in remark().
  // `machine`: the computer's id, empty if it has none. Errors: it cannot be written.
  static Expected<Outbox> open(const std::filesystem::path& path, const std::string& machine);

  const Identity& identity() const { return identity_; }
  const std::string& remark() const { return remark_; }
  // Takes another number: somebody else reports under this one.
  Expected<void> become_another(const std::string& machine);

  // The newest run that was looked at, as far as it is known here: where it begins, and its id.
  struct Place {
    std::int64_t row = 0;
    std::string run;
  };
  Expected<Place> newest_run() const;

  // `definitions`: by strategy. All of it, or nothing.
  Expected<void> keep(const Run& run, const std::map<StrategyName, Counts>& counts,
                      const std::map<StrategyName, std::string>& definitions,
                      const std::vector<Failure>& failures);

  // Whether something was not sent yet; kUrgent: a rule's strategies are exhausted, so that a person has to look.
  enum class News : std::uint8_t { kNone, kSome, kUrgent };
  Expected<News> news() const;
  // The unsent rows, oldest first: at most so many of each.
  Expected<Waiting> waiting(int most) const;
  // It was sent as it is here; later changes go again.
  Expected<void> sent(const Waiting& what);
  // How much was dropped without having been sent, in all.
  Expected<std::int64_t> dropped() const;

  // A value kept under a name; nothing: there is none.
  Expected<std::optional<std::string>> value(const std::string& name) const;
  Expected<void> set_value(const std::string& name, const std::string& value);

 private:
  Outbox(journal::Database database, std::string remark)
      : database_(std::move(database)), remark_(std::move(remark)) {}
  Expected<void> identify(const std::string& machine);
  Expected<void> write(const Run& run, const std::map<StrategyName, Counts>& counts,
                       const std::map<StrategyName, std::string>& definitions,
                       const std::vector<Failure>& failures);
  Expected<void> bound();
  Expected<void> in_one(const std::function<Expected<void>()>& write);

  journal::Database database_;
  std::string remark_;
  Identity identity_;
};

std::filesystem::path outbox_beside(const std::filesystem::path& journal);

// The identity of this computer: /etc/machine-id and, if it is readable, the number of its board.
// Empty: it has neither.
std::string machine_id();

}  // namespace culprit::fleet
