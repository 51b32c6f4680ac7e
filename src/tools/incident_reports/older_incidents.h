// Finds incidents in journals of older culprits, whose managers told none: a robot that is not well is one incident, from
// its first failure until no rule sees one.
#pragma once

#include <deque>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "incident_reports/incident.h"

namespace culprit::incident_reports {

// Those that a strategy adapts, or all that a rule is about if `strategy` is empty. By the rules that the event was told
// with.
using ComponentsOf =
    std::function<std::vector<std::string>(const std::string& rule, const std::string& strategy)>;

class OlderIncidents {
 public:
  void add(const Told& told, const ComponentsOf& components_of);
  // From here on another manager tells: what is still wrong, it finds anew. The one before was there
  // until `until`, in seconds since 1970; 0: unknown.
  void cut(double until);

  // In the order of their beginnings; the last may last.
  const std::vector<Incident>& incidents() const { return all_; }
  // Rules of which something was told while it was not known that they fail: their failures began before the first event.
  const std::set<std::string>& begun_before() const { return begun_before_; }

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

}  // namespace culprit::incident_reports
