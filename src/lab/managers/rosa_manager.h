// ROSA: a knowledge base of actions, functions, components and configurations that is planned over
// on every message, with a behaviour tree that leads the mission.
//
// Where its delays come from: every access to the knowledge base is a handful of database
// transactions, and one service call is served at a time. A message is inserted, then the planner
// queries, then a configuration is selected, then the executor fetches the plan, and only then the
// robot is asked. Each waits for the one that is served before. Even where nothing is to change,
// every message is planned for. The tree asks before each action whether it is feasible. It changes
// lifecycle states and parameters of the nodes itself, without system modes.
#pragma once

#include "managers/suave_manager.h"

namespace culprit::study {

class RosaManager : public SuaveManager {
 public:
  explicit RosaManager(const Setting& setting);

 private:
  // The robot's target or current state: the nodes that are active, and the altitude of the search.
  struct Configuration {
    std::map<std::string, bool> is_active;
    std::optional<double> altitude;

    bool operator==(const Configuration&) const = default;
  };

  Routine monitor();
  Routine plan();
  Routine execute();
  Routine lead();
  // Occupies the knowledge base for so many transactions.
  Routine transact(int transactions);
  Routine apply(Configuration wanted);
  Routine activate(std::string node, bool* is_done);
  Configuration best() const;
  void on_signal(const std::string& name, const Value& value) override;

  struct Message {
    std::string signal;
    Value value;
  };
  std::deque<Message> inbox_;
  // In the knowledge base:
  Gate base_;
  std::string action_;  // of the tree: "search", "inspect", "recharge"
  double visibility_ = 100;
  double battery_ = 1;
  std::map<std::string, bool> thrusters_;  // whether failed
  Configuration selected_;
  bool is_plan_wanted_ = false;
  bool is_plan_pending_ = false;
  Configuration active_;  // what was done of it
  Bell plan_wanted_;
  Bell plan_pending_;
};

}  // namespace culprit::study
