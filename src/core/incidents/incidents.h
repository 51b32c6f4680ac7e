// Finds incidents: one root cause with its effects, opened, changed, closed.
//
// Takes the events of each step and the knowledge, and tells IncidentOpened, IncidentChanged and
// IncidentClosed. All views of incidents, live or of a journal, are made of these.
//
// - The root is the failure that no other present failure explains. A failure is explained by a strategy that was
//   chosen, or by the diagnosis that holds it back.
// - Roots that point at the same components are one incident.
// - An incident keeps its id while its root stays, or while it keeps one of its failures and its root becomes a
//   consequence of one that had no incident yet.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "knowledge/event_log.h"
#include "knowledge/knowledge.h"

namespace culprit {

// The parts of an id. The manager has no clock on the wall; the same values give the same ids again.
struct IncidentIds {
  std::int64_t wall_at_zero = 0;  // nanoseconds since 1970 when the robot's clock showed 0
  std::string salt{};             // differs between robots and between runs
};

class Incidents {
 public:
  // Of the governor.
  struct Orders {
    bool is_paused = false;
    std::vector<StrategyId> asked{};  // strategies that wait for approval
  };
  // The current action about an incident, and the next one; the times change by themselves.
  struct Course {
    std::string doing{};  // or why nothing is
    std::string next{};   // may be empty
  };

  explicit Incidents(IncidentIds ids) : ids_(std::move(ids)) {}

  // Once in each step, after all else. Tells what changed to `events`.
  void advance(const Knowledge& knowledge, const Orders& orders, EventLog& events);
  // Whether there is anything to look at in a step without events.
  bool is_any_open() const { return !open_.empty(); }

  // As they were after the last step, in the order of comes_before().
  const std::vector<Incident>& open() const { return open_; }
  // Those of the latest decision about the failure, the likeliest first; empty: none was made.
  const std::vector<Suspect>& suspects_of(RuleId failure) const { return of(failure).suspects; }
  // Why culprit as a whole does nothing now.
  enum class Halt : std::uint8_t { kNone, kPaused, kDeaf };
  Course course_of(const Incident& incident, const Knowledge& knowledge, Halt halt) const;

 private:
  // The latest event about a failure.
  struct Failure {
    std::vector<Candidate> candidates{};
    std::vector<Suspect> suspects{};
    bool is_held_back = false;           // nothing was chosen for it
    std::optional<StrategyId> blamed{};  // the last that was chosen, be it done or not
    bool is_advice = false;              // it would be done, in a dry run
    std::vector<RuleId> explains{};      // of it
    std::string held_back{};             // why what was chosen is not done
    bool is_paused = false;              // by a person's pause
    bool is_lost = false;                // it ended unseen
  };
  void note(const Event& event, const RuleSet& rules);
  void resume();
  Failure& of(RuleId rule, const RuleSet& rules);
  const Failure& of(RuleId rule) const;
  bool is_own(RuleId rule) const;
  std::optional<RuleId> upstream_of(RuleId rule, const std::vector<RuleId>& all) const;
  RuleId root_of(RuleId rule, const std::vector<RuleId>& all) const;
  std::string unheard_host(RuleId root, const Knowledge& knowledge) const;
  std::optional<ComponentId> supplier_down(RuleId root, const Knowledge& knowledge) const;
  void blame(Incident& incident, const Knowledge& knowledge) const;
  std::vector<Incident> found(const Knowledge& knowledge) const;
  void describe_all(std::vector<Incident>& all, const Knowledge& knowledge,
                    const Orders& orders) const;
  void identify(std::vector<Incident>& all, const RuleSet& rules) const;
  std::string new_id(const Incident& incident, const RuleSet& rules,
                     const std::vector<Incident>& all) const;
  void close(const Incident& before, const std::vector<Incident>& all, Time now,
             EventLog& events) const;

  const IncidentIds ids_;
  std::vector<Failure> failures_;  // by rule
  std::vector<Incident> open_;
};

}  // namespace culprit
