// An incident: one root cause and its effects, from the first failure to the last. The manager finds it
// once (incidents/incidents.h); journal, terminal, page, alerts, messages and fleet show what it found.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/time.h"
#include "language/rule_set.h"

namespace culprit {

struct Incident {
  std::string
      id{};     // the same from its beginning to its end; no other incident of any robot has it
  RuleId root;  // the failure that none of the others explains
  std::vector<RuleId> consequences{};     // failures that are present because of it, ascending
  std::vector<ComponentId> components{};  // that are held responsible, or else suspected
  std::string host{};         // the unreachable host of these components: it is the cause
  bool is_certain = false;    // the manager holds them responsible: it decided about them
  bool is_suspected = false;  // else: the diagnosis names them
  Time since = kNever;        // of the first of its failures
  Criticality criticality = Criticality::kNonCritical;  // of the worst of its failures
  bool is_exhausted = false;                            // one of them has no strategy left
  bool has_no_remedy = false;    // no strategy for its failures acts on its components
  bool awaits_approval = false;  // a strategy against one of them waits for a person
  // Of these components: "dead", "stopped", "hung", "not heard"; empty: they work, or differ.
  std::string condition{};
  std::string headline{};  // "camera is down"

  bool needs_person() const { return is_exhausted || awaits_approval || !host.empty(); }
  bool has(RuleId rule) const {
    return rule == root ||
           std::find(consequences.begin(), consequences.end(), rule) != consequences.end();
  }
  bool operator==(const Incident&) const = default;
};

// How an incident ended.
enum class IncidentEnd : std::uint8_t {
  kResolved,  // its failures are gone
  kLost,      // what its rule reads cannot be seen any more
  kMerged     // its failures belong to another incident
};
std::string_view to_string(IncidentEnd how);  // "resolved", "lost", "merged"

// The order in which all views list open incidents: those that need a person first, then the worst, then the
// oldest.
inline bool comes_before(const Incident& a, const Incident& b) {
  if (a.needs_person() != b.needs_person()) return a.needs_person();
  if (a.criticality != b.criticality) return a.criticality > b.criticality;
  return std::pair(a.since, a.root.index) < std::pair(b.since, b.root.index);
}

}  // namespace culprit
