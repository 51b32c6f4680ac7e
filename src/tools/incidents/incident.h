// The times that a robot was not well: whose fault each was held to be, what suffered from it, for how long, and what
// helped. Made of events as journal and page have them (journal/event_json.h).
//
//     IncidentBuilder builder;
//     for (const Told& told : events) builder.add(told, components_of);
//     for (const Incident& incident : builder.incidents()) print(incident);
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "json/json.h"
#include "language/rule_set.h"

namespace culprit::incidents {

// One event, and when it was reported.
struct Told {
  std::int64_t row = 0;  // ascending: of the journal, or wherever it is found again
  double wall = 0;       // seconds since 1970
  double robot = 0;      // seconds by the robot's clock, which does not jump
  const Json& event;
};

struct Incident {
  std::int64_t first_row = 0;  // of what tells it
  std::int64_t last_row = 0;
  double began = 0;    // seconds since 1970
  double seconds = 0;  // how long; so far, if it lasts
  bool is_over = false;
  bool is_cut =
      false;  // culprit ended, or its rules were reloaded, before it was over: its end is unknown
  bool is_given_up = false;
  Criticality worst = Criticality::kNonCritical;
  std::vector<std::string>
      causes;  // components that were held responsible, or were gone; the first first
  std::vector<std::string> rules;         // that saw a failure, the first first
  std::vector<std::string> consequences;  // those of them that are about none of the causes
  std::vector<std::string> helped;        // strategies

  // A few letters made from its beginning: the same after a restart.
  std::string id() const;
};

// Those that a strategy adapts, or all that a rule is about if `strategy` is empty. By the rules of the session that reported the event.
using ComponentsOf =
    std::function<std::vector<std::string>(const std::string& rule, const std::string& strategy)>;

class IncidentBuilder {
 public:
  void add(const Told& told, const ComponentsOf& components_of);
  // From here on another manager reports: it finds existing failures again.
  void cut();

  // In the order of their beginnings; the last may last.
  const std::vector<Incident>& incidents() const { return all_; }
  // Rules with events although their failure was not reported yet: their failures began before the first event.
  const std::set<std::string>& begun_before() const { return begun_before_; }
  // Rules that see a failure at the end.
  const std::set<std::string>& failing() const { return failing_; }

 private:
  // A component was gone, which a rule may see soon.
  struct Loss {
    std::int64_t row;
    double robot;
    std::string component;
  };

  void begin(const Told& told);
  void learn(const Told& told, const std::string& type, const ComponentsOf& components_of);
  void end();

  std::vector<Incident> all_;
  double robot_began_ = 0;
  std::set<std::string> failing_;  // rules; empty: no incident is open
  bool is_blamed_ = false;         // somebody is, in the one that is open
  std::deque<Loss> losses_;
  std::set<std::string> begun_before_;
};

}  // namespace culprit::incidents
