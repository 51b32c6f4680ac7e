// Incidents of the robot, as people think of them: one root cause and its effects. Each names the
// failed components, the blamed one, the current action and the next one.
//
//     Situation situation;
//     situation.take(manager.events(), rules);            // after each step
//     for (const Incident& incident : situation.incidents(manager)) tell(incident);
//
// The page draws the same from the events (ui/src/incidents.ts), for it looks back, too.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "manager/manager.h"

namespace culprit::live {

struct Incident {
  RuleId root;                            // the failure that none of the others explains
  std::vector<RuleId> consequences{};     // failures that are there because of it
  std::vector<ComponentId> components{};  // that are held responsible, or else suspected
  std::string host{};       // the computer that is not heard, where they are: it is what is wrong
  bool is_certain = false;  // the manager holds them responsible: it decided about them
  Time since = kNever;      // of the first of its failures
  Criticality criticality = Criticality::kNonCritical;  // of the worst of its failures
  bool is_exhausted = false;                            // nothing is left to try about one of them
  bool awaits_approval = false;                         // of what is to be done about one of them
  std::string
      condition{};  // of these components: "dead", "stopped", "hung", "not heard"; empty: they work, or differ
  std::string headline{};  // "camera is dead"
  std::string doing{};     // what is done about it, or why nothing is
  std::string next{};      // what comes next, and when; may be empty

  bool needs_person() const { return is_exhausted || awaits_approval || !host.empty(); }
};

class Situation {
 public:
  // Takes what a manager did in one step, of these rules.
  void take(std::span<const Event> events, const RuleSet& rules);
  // Other rules, or another manager: existing failures are reported again.
  void forget() { failures_.clear(); }

  // Worst first. @pre take() was given all events of this manager
  std::vector<Incident> incidents(const Manager& manager) const;

 private:
  // The latest report on a failure.
  struct Failure {
    std::vector<Candidate> candidates{};
    std::vector<Suspect> suspects{};
    bool is_held_back = false;           // nothing was chosen for it
    std::optional<StrategyId> blamed{};  // the last that was chosen, be it done or not
    bool is_advice = false;              // it would be done, in a dry run
    std::vector<RuleId> explains{};      // of it
    std::string held_back{};             // why what was chosen is not done
  };
  void take(const Event& event, const RuleSet& rules);
  Failure& of(RuleId rule, const RuleSet& rules);
  const Failure& of(RuleId rule) const;
  bool is_own(RuleId rule) const;
  std::optional<RuleId> upstream_of(RuleId rule, const std::vector<RuleId>& all) const;
  RuleId root_of(RuleId rule, const std::vector<RuleId>& all) const;
  std::string unheard_host(RuleId root, const Knowledge& knowledge) const;
  void blame(Incident& incident, const Knowledge& knowledge) const;
  std::string doing_about(const Incident& incident, const Manager& manager) const;

  std::vector<Failure> failures_;  // by rule
};

}  // namespace culprit::live
