// Finds what the last run of culprit left unfinished, from its intents and its later events. The
// newest rows of both may be beside the journal only (unwritten.h).
//
// A strategy was under way if it was chosen or resumed and at least one change for it was about to
// be requested. Its success or the end of its undoing would be on record. It is not continued if
// others may have changed the robot since: another culprit managed it, or none did for longer
// than kGoneOnWith. Only rows with their original hash count (Cursor::is_as_written()).
#pragma once

#include <optional>
#include <vector>

#include "journal/history.h"
#include "journal/known_robot.h"
#include "journal/reader.h"
#include "journal/session.h"
#include "journal/unwritten.h"
#include "knowledge/interrupted.h"

namespace culprit::journal {

// The longest time without culprit after which it continues the strategies that it left unfinished.
inline constexpr Duration kGoneOnWith = std::chrono::minutes(1);

// How long culprit may have been away to expect that all is as it left it (KnownRobot::is_whole).
inline constexpr Duration kExpected = std::chrono::minutes(10);

struct Recovery {
  bool had_run = false;           // there was a run before
  bool was_stopped = false;       // and it was asked to end
  bool was_other_boot = false;    // the machine was booted since
  bool was_other_domain = false;  // or it was another robot
  bool is_other_robot() const { return was_other_boot || was_other_domain; }
  bool orders_kept = false;  // in a file of their own, which alone counts (standing_orders.h)
  bool is_paused = false;    // by a person, who has to resume it; according to the rows
  bool is_dry_run = false;   // likewise
  std::vector<Interrupted> interrupted;
  std::vector<std::string> given_up;  // what was under way and cannot be finished, and why
  History past;                       // of all runs before, on the robot's clock
  KnownRobot known_robot;             // what they saw of this robot since the machine was started
  std::string rules_text;             // of the last run
};

// Two clocks at one moment. `wall`: nanoseconds since 1970. And the DDS domain that is watched from
// then on.
struct Moment {
  Time robot;
  std::int64_t wall = 0;
  int domain = 0;
};

// `unwritten`: the rows after those of `journal`. `manager_before`: the process of the culprit that
// has managed the robot until now, 0 for one on another machine; nothing: none was. Errors: the
// file cannot be read.
Expected<Recovery> recover(const Reader& journal, const Unwritten& unwritten, const RuleSet& rules,
                           const Moment& now, std::optional<int> manager_before = {});

}  // namespace culprit::journal
