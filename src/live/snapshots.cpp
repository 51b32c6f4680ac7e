#include "live/snapshots.h"

#include <algorithm>
#include <utility>

#include "base/time.h"
#include "ros2/services.h"

namespace culprit::live {

Snapshots::Snapshots(Options options)
    : options_(std::move(options)), service_(service_of(options_.recorder)) {}

void Snapshots::joined(ros2::NodeEntry& node) {
  auto client =
      ros2::ServiceClient::create(node, {service_, std::string(ros2::srv::Snapshot::kType)});
  if (!client) return options_.say("no snapshots: " + client.error());
  client_ = std::move(*client);
}

void Snapshots::begins(const Manager& manager, std::function<Remarks()> /*remarks*/,
                       Time /*start*/) {
  manager_ = &manager;
}

void Snapshots::stepped(const Runtime::Step& step) {
  if (!std::exchange(is_looked_for_, true)) looks_ = later(step.now, kDiscovery);
  look_for_recorder(step.now);
  const Knowledge& knowledge = manager_->knowledge();
  for (const Event& event : step.events) {
    const auto* detected = std::get_if<FailureDetected>(&event.what);
    if (detected == nullptr || is_ill_) continue;
    is_ill_ = true;
    due_ = kNever;
    why_ = knowledge.rules[detected->rule].name;
    if (step.now < not_before_) continue;
    not_before_ = later(step.now, options_.after);
    ask(why_ + " is detected");
  }
  if (is_ill_ && knowledge.states.active().empty()) {
    is_ill_ = false;
    due_ = later(step.now, options_.after);
  }
  if (step.now < due_) return;
  due_ = kNever;
  ask("after " + why_);
}

Time Snapshots::next_look() const { return std::min(due_, looks_); }

void Snapshots::look_for_recorder(Time now) {
  if (now < looks_) return;
  looks_ = kNever;
  if (client_ && !client_->is_ready())
    options_.say("no snapshots yet: no node offers " + service_ +
                 ", as 'ros2 bag record --snapshot-mode' does");
}

void Snapshots::ask(const std::string& why) {
  if (!client_) return;
  const auto on_answer = [say = options_.say, service = service_,
                          why](const ros2::CallResult& result) {
    if (result.outcome == ros2::CallOutcome::kUnreachable)
      return say("no snapshot (" + why + "): no node offers " + service);
    const auto answer = result.outcome == ros2::CallOutcome::kAnswered
                            ? rtps::decode<ros2::srv::Snapshot::Response>(result.reply)
                            : std::nullopt;
    if (!answer) return say("no snapshot (" + why + "), perhaps: " + service + " does not answer");
    say(answer->success ? service + " wrote a snapshot (" + why + ")"
                        : "no snapshot (" + why + "): " + service + " refused it");
  };
  client_->call(rtps::encode(ros2::srv::Snapshot::Request{}), ros2::Repeat::kNever, kPatience,
                on_answer);
}

}  // namespace culprit::live
