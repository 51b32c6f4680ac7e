// The robot as the culprit that manages it says it is (docs/web.md: the documents robot, graph and state): whether it is
// well, which process a component is, which components are silent.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "drill/trial.h"

namespace culprit::drill {

// The robot while it was well, for a record that outlives it.
struct HealthyRobot {
  struct Topic {
    double rate = 0;          // Hz
    std::string publisher{};  // components
    std::set<std::string> subscribers{};
  };
  std::vector<std::pair<std::string, std::string>> edges{};  // consumer, producer
  std::map<std::string, std::string> lifecycles{};           // of each component; may be empty
  std::map<std::string, Topic> topics{};                     // that rules watch
};
Json to_json(const HealthyRobot& robot);
HealthyRobot healthy_from(const Json& json);

class RobotView {
 public:
  // Documents of any form; what they do not say is unknown.
  RobotView(Json robot, Json graph, Json state)
      : robot_(std::move(robot)), graph_(std::move(graph)), state_(std::move(state)) {}

  // "RGBDead is failing", "camera is gone". Empty: it is well. A rule that was blind in `healthy`, or a
  // component that was gone there, is no complaint.
  std::vector<std::string> complaints(const RobotView* healthy = nullptr) const;

  struct Component {
    std::string node;  // full name; empty: unknown
    int pid = 0;       // 0: unknown, or of another computer
    bool is_alive = false;
    std::string lifecycle{};  // empty: unknown, or it has none
  };
  std::map<std::string, Component> components() const;

  // Whether its trigger has a value, and is false or true.
  std::optional<bool> trigger(const std::string& rule) const;

  // The topics that rules watch.
  std::vector<std::string> topics() const;
  // `publishers`: nodes by topic, for topics that no node subscribes to: the graph has no edge for them.
  HealthyRobot healthy(const std::map<std::string, std::string>& publishers = {}) const;

  // Components that publish a watched topic which is silent for longer than is usual in `healthy`.
  std::set<std::string> silent(const HealthyRobot& healthy) const;

 private:
  std::vector<std::pair<std::string, std::string>> edges() const;

  Json robot_;
  Json graph_;
  Json state_;
};

}  // namespace culprit::drill
