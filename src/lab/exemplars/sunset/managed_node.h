// Base of SUNSET's five managed nodes: a lifecycle, a heartbeat, fault parameters that heal by
// restart or by redeployment, and parameters that outlive the process.
//
// - At the start of the process a node takes its parameters' last values, configures and activates
//   itself. Configuring costs time, in which nothing is answered.
// - Publishers and subscriptions of pictures exist only while it is active; the heartbeat from
//   configuring on. Parameters and what a node has buffered survive a restart.
// - Each node defines the effect of its fault parameters. Configuring clears some of them,
//   activating others: so a redeployment heals both kinds, a restart the second.
// - A shutdown transition ends the process.
//
// Left out, because nothing here uses it: the service ~/set_lifecycle_changes (a list of
// transitions; we offer the standard lifecycle services), the topic ~/experiment_log, and
// parameters and topics that the exemplar's scenarios do not touch and its nodes do not read.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/expected.h"
#include "base/invariant.h"
#include "exemplars/sunset/heartbeat.h"
#include "exemplars/sunset/members.h"
#include "exemplars/sunset/node_options.h"
#include "exemplars/sunset/parameter_file.h"
#include "ros2/executor.h"
#include "ros2/lifecycle_node.h"

namespace culprit::sunset {

class ManagedNode {
 public:
  struct Traits {
    Member member;
    std::vector<std::pair<std::string, Value>> parameters;  // with their defaults
    std::vector<std::string> cleared_by_configure = {};     // set to false
    std::vector<std::string> cleared_by_activate = {};
    double configure_sec = 0;  // robot seconds
    bool activates_itself = true;
  };

  ManagedNode(Traits traits, NodeOptions options);
  virtual ~ManagedNode();

  // Joins, and comes up as soon as the executor runs. The context outlives the node.
  Expected<void> open(ros2::Context& context);

 protected:
  ros2::Node& node() { return managed_->node(); }
  const NodeOptions& options() const { return options_; }
  // @pre configured
  Heartbeat& heartbeat() {
    CULPRIT_ASSERT(heartbeat_);
    return *heartbeat_;
  }
  bool is_active() const;

  template <class T>
  T parameter(std::string_view name) {
    return node().parameters().get<T>(name);
  }
  // Puts what was created into its place.
  template <class Place, class Thing>
  static Expected<void> keep(Place& place, Expected<Thing> created) {
    if (!created) return Error{created.error()};
    place = std::move(*created);
    return {};
  }
  // The node itself changes a parameter; everybody sees it.
  void assign(std::string_view name, Value value);

 private:
  // Loads what takes time; counts towards the time that configuring takes.
  virtual void configure() {}
  // Creates publishers and subscriptions.
  virtual Expected<void> activate() = 0;
  // Destroys them; also after an activation that failed.
  virtual void deactivate() = 0;
  // Called for a request to change a parameter. An error refuses.
  virtual Expected<void> on_set(const ros2::msg::Parameter&) { return {}; }

  Expected<void> declare_parameters();
  void remember(std::span<const ros2::msg::Parameter> changes);
  void clear(std::span<const std::string> faults);
  void come_up();
  ros2::TransitionResult on_configure();
  ros2::TransitionResult on_activate();
  ros2::TransitionResult on_deactivate();
  ros2::TransitionResult on_release();
  ros2::TransitionResult on_shutdown();

  const Traits traits_;
  const NodeOptions options_;
  std::optional<ParameterFile> file_;
  std::unique_ptr<ros2::LifecycleNode> managed_;
  std::unique_ptr<Heartbeat> heartbeat_;
  std::optional<ros2::TaskGroup> tasks_;
};

}  // namespace culprit::sunset
