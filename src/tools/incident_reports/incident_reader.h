// Reads incidents from the events that a manager tells of them (incidents/incidents.h).
//
//     IncidentReader reader;
//     for (const Told& told : events) reader.add(told);
//     for (const Incident& incident : reader.incidents()) print(incident);
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "incident_reports/incident.h"

namespace culprit::incident_reports {

class IncidentReader {
 public:
  void add(const Told& told);
  // From here on another manager tells: it opens what is still wrong anew. The one before was there
  // until `until`, in seconds since 1970; 0: unknown.
  void cut(double until);

  // In the order of their beginnings; those that are not over last.
  const std::vector<Incident>& incidents() const { return all_; }
  // Incidents that were opened before the first event.
  const std::set<std::string>& begun_before() const { return begun_before_; }
  bool has(const std::string& id) const;

 private:
  // A component was gone, which a rule may see soon.
  struct Loss {
    std::int64_t row;
    double robot;
    std::string component;
  };
  struct Open {
    std::size_t place;   // in all_
    double robot_began;  // seconds by the robot's clock
    bool is_certain = false;
  };

  Open& opened(const Told& told, const std::string& id, const std::string& type);
  void take(const Told& told, const std::string& id, const std::string& type);
  void close(const Told& told, const std::string& id);
  void note(const Told& told, const std::string& type);

  std::vector<Incident> all_;
  std::map<std::string, Open> open_;              // by id
  std::map<std::string, std::int64_t> detected_;  // by rule: the row that told of its failure
  std::deque<Loss> losses_;
  std::set<std::string> begun_before_;
};

}  // namespace culprit::incident_reports
