// One process of the live robot: the mission (model/mission.h). It waits until the search and the
// following accept goals, begins, and reports its end.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "exemplars/suave/bridge.h"
#include "exemplars/suave/live_helm.h"
#include "exemplars/suave/live_names.h"
#include "exemplars/suave/model/mission.h"
#include "exemplars/suave/paced_world.h"

namespace culprit::suave {

class MissionProcess {
 public:
  MissionProcess(NodeOptions options, const model::Generation& generation,
                 const model::MissionPlan& plan);

  // The context outlives the process.
  Expected<void> open(ros2::Context& context);

 private:
  using Modes = std::unique_ptr<ros2::ServiceClient>;

  Expected<void> open_topics();
  Expected<void> open_modes(const char* system);
  void wait_for(const std::string& system);
  void on_mode(const std::string& system, const std::string& mode);
  void begin();
  void change_mode(const char* system, const char* mode);

  const NodeOptions options_;
  const model::Generation& generation_;
  const model::MissionPlan& plan_;
  simulation::World world_;
  model::Topics model_topics_;
  std::unique_ptr<ros2::Node> node_;
  std::unique_ptr<Bridge> bridge_;
  std::unique_ptr<LiveHelm> helm_;
  std::optional<ros2::Publisher<ros2::msg::Bool>> done_;
  std::unique_ptr<ros2::Subscription> inspected_;
  std::unique_ptr<ros2::Client<ros2::srv::Trigger>> start_;
  std::map<std::string, bool> is_ready_;  // by system
  bool has_begun_ = false;
  std::unique_ptr<model::Mission> mission_;
  std::optional<PacedWorld> pace_;
  std::optional<ros2::TaskGroup> tasks_;  // outlives those that post to it
  std::map<std::string, Modes> modes_;    // by system
};

}  // namespace culprit::suave
