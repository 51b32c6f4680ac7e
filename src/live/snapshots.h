// Has a recorder that runs beside the robot (`ros2 bag record --snapshot-mode`) write what it has in its memory: when a
// failure is detected, for what led to it, and again some seconds after all is well, for what came then. Each snapshot
// begins where the one before it ended.
//
// culprit does not own the recorder: it changes nothing of the robot, and nothing depends on whether it answers. A failure that comes and goes asks for no more
// than two in each Options::after.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "live/observer.h"
#include "ros2/service_client.h"

namespace culprit::live {

class Snapshots : public Observer {
 public:
  struct Options {
    std::string recorder;  // its node, in full: "/rosbag2_recorder"
    Duration after = std::chrono::seconds(10);
    // Told what was asked for, and why there is none. From any thread; it must outlive the last call, which may
    // be under way.
    std::function<void(const std::string&)> say;
  };
  // So long an answer may take: a slow disk has to take all of its memory.
  static constexpr Duration kPatience = std::chrono::seconds(30);
  // So long it may take to be discovered before that is said.
  static constexpr Duration kDiscovery = std::chrono::seconds(10);

  // The service of such a recorder.
  static std::string service_of(const std::string& recorder) { return recorder + "/snapshot"; }

  explicit Snapshots(Options options);

  void joined(ros2::NodeEntry& node) override;
  void leaves() override { client_.reset(); }
  void begins(const Manager& manager, std::function<Remarks()> remarks, Time start) override;
  void stepped(const Runtime::Step& step) override;
  Time next_look() const override;
  void announced(Time, const EventWords&, const std::string&) override {}

 private:
  void look_for_recorder(Time now);
  void ask(const std::string& why);

  const Options options_;
  const std::string service_;
  std::unique_ptr<ros2::ServiceClient> client_;  // null: there is no node now, or it may not
  const Manager* manager_ = nullptr;             // null: none has begun
  std::string why_;                              // the failure that was detected last
  bool is_ill_ = false;
  Time due_ = kNever;           // of the snapshot after all is well
  Time not_before_ = kLongAgo;  // of the next one about a detection
  bool is_looked_for_ = false;
  Time looks_ = kNever;  // when it says that there is no recorder; kNever: that was looked at
};

}  // namespace culprit::live
