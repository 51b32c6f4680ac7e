// t02: a robot of your own behind the port (robot/robot.h), driven by the runtime.
//
// A robot says what was observed and carries out what it is asked. This one lives in virtual time:
// it moves its clock instead of waiting, so that the example is over at once. A live one waits.
#include <atomic>
#include <cstdio>

#include "knowledge/describe.h"
#include "language/checker.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/bayes/bayes_planner.h"

using namespace culprit;
using namespace std::chrono_literals;

namespace {

constexpr const char* kRules = R"(
COMPONENT lidar NODE /lidar LAUNCH "lidar_driver"

RULE LidarSilent
  POLICIES ERROR
  TRIGGER age(/scan) > 500ms
    STRATEGY redeploy 90 10
      ADAPTATION lidar redeploy 5
)";

// A lidar that publishes ten times a second, and dies after three seconds.
class Lidar : public Robot {
 public:
  Time now() const override { return now_; }

  void observe(Time until, std::vector<Observation>& observations) override {
    now_ = std::min(until, next_);
    if (now_ == Time(3s))
      tell(observations, ProcessSeen{kLidar, ProcessState::kGone, pid_, "crashed"});
    runs_ = runs_ && now_ != Time(3s);
    if (!is_seen_ && runs_) {
      is_seen_ = true;
      tell(observations, ProcessSeen{kLidar, ProcessState::kRunning, pid_, ""});
      tell(observations, NodeAppeared{"/lidar", pid_});
      tell(observations, EndpointAppeared{"/lidar", EndpointKind::kPublisher, "/scan"});
    }
    if (now_ == next_) {
      if (runs_) tell(observations, SampleArrived{kScan});
      next_ += 100ms;
    }
    for (const CommandId id : done_) tell(observations, Reply{id, Outcome::kDone, {}, ""});
    done_.clear();
  }

  void execute(const Command& command) override {
    std::printf("        asked: %s\n", to_string(command).c_str());
    if (std::holds_alternative<StartProcess>(command.what)) {
      runs_ = true;
      is_seen_ = false;
      ++pid_;
    }
    done_.push_back(command.id);
  }

 private:
  static constexpr ComponentId kLidar{0};
  static constexpr TopicId kScan{0};

  template <class What>
  void tell(std::vector<Observation>& observations, What what) const {
    observations.push_back({now_, std::move(what)});
  }

  Time now_{};
  Time next_ = Time(100ms);
  bool runs_ = true;
  bool is_seen_ = false;
  int pid_ = 1000;
  std::vector<CommandId> done_;
};

}  // namespace

int main() {
  const Checked checked = check(Source("lidar.rules", kRules));
  if (!checked.rules) return 1;
  const RuleSet& rules = *checked.rules;
  Manager::Options options;
  options.discovery = 1s;
  Manager manager(rules, std::make_unique<BayesPlanner>(), options);
  Lidar robot;
  Runtime runtime(manager, robot);
  bool is_healed = false;
  runtime.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events) {
      is_healed = is_healed || std::holds_alternative<FailureResolved>(event.what);
      const std::string text = describe(event, rules);
      if (!text.empty())
        std::printf("%5.1f s %s\n", seconds(event.at.time_since_epoch()), text.c_str());
    }
  };
  const std::atomic<bool> stop = false;
  runtime.run(stop, Time(10s));
  return is_healed ? 0 : 1;
}
