#include "link/parameter_watch.h"

#include "base/live_clock.h"
#include "base/name_grammar.h"
#include "link/list_parameter.h"

namespace culprit::ros2 {

Expected<void> ParameterWatch::start(NodeEntry& self) {
  // Best effort and deep: many nodes announce at once when a robot starts.
  constexpr Qos kQos{.reliability = Reliability::kBestEffort, .depth = 100};
  auto subscription = RawSubscription::create(
      self, "/parameter_events", msg::ParameterEvent::kType, kQos, PayloadUse::kWhole,
      [this](const Sample& sample) {
        constexpr std::size_t kMost = msg::ParameterEvent::kLargest;  // bytes that wait
        const std::size_t size = sample.payload.size();
        if (waiting_ + size > kMost) return;
        auto event = decode<msg::ParameterEvent>(sample.payload);
        if (!event) return;
        waiting_ += size;
        tasks_.post([this, size, event = std::move(*event), writer = sample.identity.writer] {
          waiting_ -= size;
          on_event(event, writer);
        });
      });
  if (!subscription) return Error{subscription.error()};
  subscription_ = std::move(*subscription);
  return {};
}

void ParameterWatch::on_event(const msg::ParameterEvent& event, const Guid& writer) {
  const auto component = binding_.bind(event.node);
  if (!component || others_.has(*component, event.node)) return;
  const Graph::Owner owner = context_.graph().owner_of(writer);
  if (owner.node != event.node || !owner.counts) return ask(*component, event.node, owner.node);
  for (const auto* changes : {&event.new_parameters, &event.changed_parameters}) {
    for (const msg::Parameter& changed : *changes) {
      for (std::size_t p = 0; p < rules_.parameters.size(); ++p) {
        const Parameter& wanted = rules_.parameters[p];
        if (wanted.component != *component || wanted.name != changed.name) continue;
        if (auto value = value_or_list(changed.value))
          inbox_.put(ParameterRead{ParameterId(p), std::move(*value)});
      }
    }
  }
}

void ParameterWatch::ask(ComponentId component, const std::string& node, const std::string& by) {
  constexpr Duration kPause = std::chrono::seconds(1);
  constexpr std::size_t kMost = 100;
  const Time now = live_now();
  Time& asked = asked_.try_emplace(component, kLongAgo).first->second;
  if (now < later(asked, kPause)) return;
  asked = now;
  ask_(component);
  if (by.empty() || told_of_.size() >= kMost || !told_of_.emplace(node, by).second) return;
  inbox_.put(LinkTrouble{printable(by) + " published that parameters of " + node +
                         " changed; culprit believes only what that node answers"});
}

}  // namespace culprit::ros2
