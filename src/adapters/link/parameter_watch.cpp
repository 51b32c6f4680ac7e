#include "link/parameter_watch.h"

#include <optional>

#include "base/live_clock.h"
#include "base/name_grammar.h"
#include "link/list_parameter.h"

namespace culprit::link {

Expected<void> ParameterWatch::start(ros2::NodeEntry& self) {
  // Best effort and deep: many nodes announce at once when a robot starts.
  constexpr rtps::Qos kQos{.reliability = rtps::Reliability::kBestEffort, .depth = 100};
  auto subscription = ros2::RawSubscription::create(
      self, "/parameter_events", ros2::msg::ParameterEvent::kType, kQos, ros2::PayloadUse::kWhole,
      [this](const ros2::Sample& sample) { on_sample(sample); });
  if (!subscription) return Error{subscription.error()};
  subscription_ = std::move(*subscription);
  return {};
}

void ParameterWatch::on_sample(const ros2::Sample& sample) {
  const std::size_t size = sample.payload.size();
  if (size > ros2::msg::ParameterEvent::kLargest) return;
  const rtps::Guid& writer = sample.identity.writer;
  auto room = WaitingLookups::Room::kNone;
  {
    const MutexLock lock(mutex_);
    room = waiting_.admit(writer, size);
  }
  if (room == WaitingLookups::Room::kNone) return;
  std::optional<ros2::msg::ParameterEvent> event;
  if (room == WaitingLookups::Room::kMessage)
    event = rtps::decode<ros2::msg::ParameterEvent>(sample.payload);
  tasks_.post([this, size, room, writer, event = std::move(event)] {
    {
      const MutexLock lock(mutex_);
      waiting_.done(writer, size, room);
    }
    if (event) return on_event(*event, writer);
    if (room == WaitingLookups::Room::kWriterOnly) on_lost_event(writer);
  });
}

void ParameterWatch::on_event(const ros2::msg::ParameterEvent& event, const rtps::Guid& writer) {
  const auto component = binding_.find(event.node);
  if (!component || others_.has(*component, event.node)) return;
  const ros2::Graph::Owner owner = context_.graph().owner_of(writer);
  if (owner.node != event.node || !owner.counts) return doubt(*component, event.node, owner.node);
  for (const auto* changes : {&event.new_parameters, &event.changed_parameters}) {
    for (const ros2::msg::Parameter& changed : *changes) {
      for (std::size_t p = 0; p < rules_.parameters.size(); ++p) {
        const Parameter& wanted = rules_.parameters[p];
        if (wanted.component != *component || wanted.name != changed.name) continue;
        if (auto value = value_or_list(changed.value))
          inbox_.put(ParameterRead{ParameterId(p), std::move(*value)});
      }
    }
  }
}

void ParameterWatch::on_lost_event(const rtps::Guid& writer) {
  const ros2::Graph::Owner owner = context_.graph().owner_of(writer);
  const auto component = binding_.find(owner.node);
  if (component && owner.counts && !others_.has(*component, owner.node)) ask(*component);
}

void ParameterWatch::doubt(ComponentId component, const std::string& node, const std::string& by) {
  constexpr std::size_t kMost = 100;
  ask(component);
  if (by.empty() || told_of_.size() >= kMost || !told_of_.emplace(node, by).second) return;
  inbox_.put(LinkTrouble{printable(by) + " published that parameters of " + node +
                         " changed; culprit believes only what that node answers"});
}

// At most once a second, and once more after the last event.
void ParameterWatch::ask(ComponentId component) {
  constexpr Duration kPause = std::chrono::seconds(1);
  const Time now = live_now();
  Asked& asked = asked_[component];
  if (now < later(asked.last, kPause)) {
    if (!std::exchange(asked.is_due, true))
      tasks_.post_at(ros2::Executor::Clock::now() + kPause, [this, component] {
        asked_[component].is_due = false;
        ask(component);
      });
    return;
  }
  asked.last = now;
  ask_(component);
}

}  // namespace culprit::link
