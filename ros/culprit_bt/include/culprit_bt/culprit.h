// Reports of a running culprit about the robot, and whether it still runs.
//
//     auto culprit = Culprit::of(config, "/culprit");
//     const Knowledge known = culprit->knowledge();
//     if (!known.status) say(known.why_not);
//
// A status is told only when something changed, so an old one is as good as a new one, as long as the
// culprit that told it is there. A culprit that was killed looks as if it were, until its lease in DDS is
// over (20 s). So it is asked once a second, by a service that it has as every node has it, and what does
// not answer for kPatience is not there. Reports of an earlier culprit are dropped then.
//
// Its functions may be called on any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "behaviortree_cpp/tree_node.h"
#include "culprit_bt/ros_thread.h"
#include "culprit_msgs/msg/status.hpp"
#include "rcl_interfaces/srv/get_parameters.hpp"
#include "rclcpp/rclcpp.hpp"

namespace culprit_bt {

struct Knowledge {
  std::shared_ptr<const culprit_msgs::msg::Status> status;  // null: nothing is known
  std::string why_not;     // why nothing is, for people; empty where something is
  std::uint64_t life = 0;  // of which culprit: another number once it was started again
};

class Culprit {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kPatience{3};
  static constexpr std::chrono::seconds kAskEvery{1};

  // The culprit with this node name ("/culprit"), for the tree that a leaf with this configuration belongs
  // to; its leaves share it. Throws as RosThread::of does, and rclcpp's exceptions for what is no name.
  static std::shared_ptr<Culprit> of(const BT::NodeConfig& config, const std::string& name);

  Culprit(std::shared_ptr<RosThread> thread, std::string name);
  ~Culprit();
  Culprit(const Culprit&) = delete;
  Culprit& operator=(const Culprit&) = delete;

  const std::string& name() const { return name_; }
  RosThread& thread() const { return *thread_; }
  Knowledge knowledge() const;

 private:
  using Status = culprit_msgs::msg::Status;
  using Ask = rcl_interfaces::srv::GetParameters;

  // Callbacks run within it. The executor may still hold, and run, what is due when its owner ends: since Jazzy also
  // timers that were let go. None runs then, and the end waits for the one that runs.
  class Life {
   public:
    template <class Callback>
    void within(Callback callback) {
      const std::scoped_lock lock(mutex_);
      if (!is_over_) callback();
    }
    void end() {
      const std::scoped_lock lock(mutex_);
      is_over_ = true;
    }

   private:
    std::mutex mutex_;
    bool is_over_ = false;
  };

  void subscribe();
  void heard(std::shared_ptr<const Status> status, const rclcpp::MessageInfo& info);
  void look();
  void forget(std::string why_not);  // with the mutex held

  const std::shared_ptr<RosThread> thread_;
  const std::string name_;
  const std::shared_ptr<Life> callbacks_ = std::make_shared<Life>();

  mutable std::mutex mutex_;
  std::shared_ptr<const Status> status_;
  std::string why_not_;
  std::uint64_t life_ = 0;
  std::optional<rmw_gid_t> writer_;  // of the status
  bool answers_ = false;
  bool is_silent_ = false;  // it is there, and did not answer when it was asked last
  bool is_asked_ = false;
  std::int64_t request_ = 0;  // that is open, if it is asked
  Clock::time_point asked_{};

  rclcpp::Client<Ask>::SharedPtr client_;
  rclcpp::Subscription<Status>::SharedPtr subscription_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace culprit_bt
