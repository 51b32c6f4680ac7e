// A time that a robot was not well, from its beginning to its end, as a journal or the stream of a running culprit tells
// it: its causes, what suffered, for how long, and what helped.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "json/json.h"
#include "language/rule_set.h"

namespace culprit::incident_reports {

// One event (journal/event_json.h), and when it was told.
struct Told {
  std::int64_t row = 0;  // ascending: of the journal, or wherever it is found again
  double wall = 0;       // seconds since 1970
  double robot = 0;      // seconds by the robot's clock, which does not jump
  const Json& event;
};

struct Incident {
  std::string id;
  std::int64_t first_row = 0;  // of what tells it
  std::int64_t last_row = 0;
  double began = 0;    // seconds since 1970
  double seconds = 0;  // how long; so far, if it lasts
  bool is_over = false;
  // culprit ended, or its rules were reloaded, before it was over: nobody saw how it ended.
  bool is_cut = false;
  bool is_lost = false;  // what its rule reads could not be seen any more
  std::string
      merged_into;  // the id of the incident that its failures belonged to at its end; empty: none
  bool is_given_up = false;
  bool needs_person = false;                            // as it was told last
  Criticality criticality = Criticality::kNonCritical;  // likewise
  Criticality worst = Criticality::kNonCritical;
  std::vector<std::string>
      causes;  // components that were held responsible, or were gone; the first first
  std::vector<std::string> rules;         // that saw a failure, the first first
  std::vector<std::string> consequences;  // those of them that another one explains
  std::vector<std::string> helped;        // strategies
};

// The order of all lists: those that are open as all views of them have them (knowledge/incident.h); then those that are
// over, the newest first.
bool comes_before(const Incident& a, const Incident& b);

// An id of a beginning, in seconds since 1970, as journals of older culprits have it: "mywpiwzf".
std::string id_of_beginning(double began);

// It lasted at least until `until`, in seconds since 1970, and nobody saw its end.
void cut_off(Incident& incident, double until);

void add_to(std::vector<std::string>& names, const std::string& name);
Criticality criticality_of(const Json& event);

}  // namespace culprit::incident_reports
