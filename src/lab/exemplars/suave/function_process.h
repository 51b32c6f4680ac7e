// One process of the live robot: a function of the model as a managed node (search, follow,
// recover, recharge). It configures itself at its start and does nothing until it is activated.
#pragma once

#include <memory>
#include <optional>

#include "exemplars/suave/bridge.h"
#include "exemplars/suave/live_helm.h"
#include "exemplars/suave/live_names.h"
#include "exemplars/suave/model/functions.h"
#include "exemplars/suave/paced_world.h"
#include "ros2/lifecycle_node.h"

namespace culprit::suave {

enum class Function : std::uint8_t { kSearch, kFollow, kMotion, kRecharge };

class FunctionProcess {
 public:
  FunctionProcess(Function function, NodeOptions options, const model::Generation& generation);

  // The context outlives the process.
  Expected<void> open(ros2::Context& context);

 private:
  std::unique_ptr<simulation::Node> make();
  Expected<void> open_node(ros2::Context& context);
  Expected<void> declare_parameters();
  ros2::TransitionResult activate();
  ros2::TransitionResult deactivate();
  void begin_if_ready();
  void change(Transition transition);

  const Function function_;
  const NodeOptions options_;
  const model::Generation& generation_;
  simulation::World world_;
  model::Topics model_topics_;
  std::unique_ptr<ros2::LifecycleNode> managed_;
  std::unique_ptr<Bridge> bridge_;
  std::unique_ptr<LiveHelm> helm_;
  std::unique_ptr<simulation::Node> node_;
  bool is_wanted_ = false;  // active
  std::optional<PacedWorld> pace_;
  std::optional<ros2::TaskGroup> tasks_;
};

}  // namespace culprit::suave
