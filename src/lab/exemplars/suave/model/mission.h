// The mission: first search the pipeline, then inspect it, until the time is over.
#pragma once

#include <functional>

#include "exemplars/suave/model/helm.h"
#include "exemplars/suave/model/members.h"
#include "exemplars/suave/model/mission_plan.h"
#include "simulation/mode_manager.h"

namespace culprit::suave::model {

// Turns the mission's tasks into modes.
enum class Leader : std::uint8_t {
  kMission,  // the mission itself: a mode for each task, the same all along
  kBridge,   // a manager that hears which task it is (suave_msgs/Task)
  kManager   // a manager that also decides which task it is
};

// Which modes the systems and their nodes have.
culprit::modes::Model mode_model();

class Mission : public simulation::Node, private simulation::Watcher {
 public:
  // All must outlive the mission.
  Mission(simulation::World& world, Topics& topics, const Generation& generation,
          const MissionPlan& plan, Leader leader, Time guided, const Helm& helm);
  ~Mission() override;

  // When it ended; nothing while it goes on.
  std::optional<Time> ended() const { return ended_; }
  // Called when it ends.
  std::function<void()> on_end;
  // Has a system's mode changed. Must be set for a mission that leads itself.
  std::function<void(const char* system, const char* mode)> change_mode;

 private:
  void on_start() override;
  void on_field(const simulation::TopicBase& topic, const std::string& field,
                const Value& value) override;
  void begin();
  void poll();
  void end();
  void begin_task(const char* task);
  void ground(const char* system, const char* mode);

  const Generation& generation_;
  const MissionPlan& plan_;
  Leader leader_;
  Time guided_;
  const Helm& helm_;
  simulation::Topic<Data>& inspected_topic_;
  simulation::Publisher<Data> task_topic_;
  bool is_inspecting_ = false;
  std::optional<Time> ended_;
};

}  // namespace culprit::suave::model
