// Injects the faults of a drill, and undoes them.
//
// A process is stopped by a guard, a process of its own that continues it after the time, or as soon as the drill
// itself has ended, however that ended.
#pragma once

#include <memory>
#include <thread>

#include "cli/drill_loss.h"
#include "drill/injected.h"
#include "ros2/node.h"
#include "ros2/services.h"

namespace culprit::cli {

// Requests to nodes. Each returns within 3 s.
class DrillNode {
 public:
  // Joins the domain of the environment. Errors: it cannot.
  static Expected<std::unique_ptr<DrillNode>> join();
  ~DrillNode();

  Expected<Value> parameter(const std::string& node, const std::string& name);
  Expected<void> set_parameter(const std::string& node, const std::string& name,
                               const Value& value);
  // "active", "inactive" ...
  Expected<std::string> lifecycle(const std::string& node);
  Expected<void> change(const std::string& node, std::uint8_t transition);
  // A node that publishes each of these topics, as far as it was discovered. Returns at once.
  std::map<std::string, std::string> publishers_of(const std::vector<std::string>& topics);

 private:
  DrillNode() = default;
  Expected<ros2::ServiceClient*> lifecycle_client(const std::string& node);

  ros2::Executor executor_;
  std::unique_ptr<ros2::Context> context_;
  std::unique_ptr<ros2::Node> node_;
  std::map<std::string, std::unique_ptr<ros2::ServiceClient>> lifecycle_clients_;
  std::map<std::string, std::unique_ptr<ros2::Client<ros2::srv::GetParameters>>> getters_;
  std::map<std::string, std::unique_ptr<ros2::Client<ros2::srv::SetParameters>>> setters_;
  std::thread thread_;
};

class DrillInjector {
 public:
  explicit DrillInjector(DrillNode& node) : node_(node) {}
  ~DrillInjector() { release(); }

  // Reads the state that undoing it needs. Errors: it cannot be injected, or not be undone.
  Expected<drill::Injected> prepare(const drill::Fault& fault, const std::string& node, int pid);
  // `lasts`: of a fault that ends by itself.
  Expected<void> inject(const drill::Injected& fault, Duration lasts);
  // True: there was something to undo, and it is undone. Errors: it cannot be undone now.
  Expected<bool> undo(const drill::Injected& fault);
  // Lets stopped processes go on now.
  void release();

 private:
  Expected<void> inject_now(const drill::Injected& fault, Duration lasts);
  Expected<void> stop_for(const drill::ProcessId& process, Duration lasts, bool in_rhythm);
  Expected<bool> undo_lifecycle(const drill::Injected& fault);
  Expected<bool> undo_parameter(const drill::Injected& fault);

  DrillNode& node_;
  std::vector<FaultGuard> guards_;
  // Without an answer of its node. The node may obey later, so a look at its state proves nothing.
  std::vector<drill::Injected> in_doubt_;
};

}  // namespace culprit::cli
