#include "link/node_reading.h"

#include <algorithm>

#include "link/list_parameter.h"
#include "ros2/lifecycle.h"

namespace culprit::link {
namespace {

// How long a node that was just seen may take until its services answer.
constexpr Duration kAnswerPatience = std::chrono::seconds(5);

// Bytes of a name and a text in events, which anybody may send in the node's name.
constexpr std::size_t kMaxParameterName = 256;
constexpr std::size_t kMaxParameterText = 64 << 10;

}  // namespace

LiveInventory::Node NodeReading::told() const {
  const MutexLock lock(mutex_);
  return told_;
}

void NodeReading::service_seen(const std::string& service) {
  if (service == node_ + "/list_parameters") list_parameters();
  if (service == node_ + "/get_state") read_lifecycle();
}

void NodeReading::list_parameters() {
  if (list_) return;
  auto client = self_.create_client<ros2::srv::ListParameters>(node_ + "/list_parameters",
                                                               rtps::qos::kParameterServices);
  if (!client) return;
  list_ = std::move(*client);
  list_->call({}, ros2::Repeat::kUntilAnswered, kAnswerPatience,
              [this](const ros2::Client<ros2::srv::ListParameters>::Answer& answer) {
                if (answer.response) get_parameters(answer.response->names);
              });
}

void NodeReading::get_parameters(std::vector<std::string> names) {
  names.resize(std::min(names.size(), kMaxParameters));
  {
    const MutexLock lock(mutex_);
    told_.parameters.emplace();
    for (const std::string& name : names) (*told_.parameters)[name];
  }
  auto client = self_.create_client<ros2::srv::GetParameters>(node_ + "/get_parameters",
                                                              rtps::qos::kParameterServices);
  if (!client) return;
  get_ = std::move(*client);
  get_->call({names}, ros2::Repeat::kUntilAnswered, kAnswerPatience,
             [this, names](const ros2::Client<ros2::srv::GetParameters>::Answer& answer) {
               if (!answer.response) return;
               const auto& values = answer.response->values;
               const MutexLock lock(mutex_);
               for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i)
                 (*told_.parameters)[names[i]] = value_or_list(values[i]);
             });
}

void NodeReading::parameters_changed(const ros2::msg::ParameterEvent& event) {
  const MutexLock lock(mutex_);
  if (!told_.parameters) return;  // they will be read as they are then
  for (const auto* changes : {&event.new_parameters, &event.changed_parameters}) {
    for (const ros2::msg::Parameter& changed : *changes) {
      const bool has_room =
          told_.parameters->size() < kMaxParameters && changed.name.size() <= kMaxParameterName;
      if (!has_room && !told_.parameters->contains(changed.name)) continue;
      auto value = value_or_list(changed.value);
      const auto* text = value ? std::get_if<std::string>(&*value) : nullptr;
      if (text != nullptr && text->size() > kMaxParameterText) value.reset();
      (*told_.parameters)[changed.name] = std::move(value);
    }
  }
  for (const ros2::msg::Parameter& deleted : event.deleted_parameters)
    told_.parameters->erase(deleted.name);
}

void NodeReading::read_lifecycle() {
  if (state_) return;
  constexpr rtps::Qos kQos{.reliability = rtps::Reliability::kBestEffort, .depth = 10};
  auto transitions = self_.create_subscription<ros2::msg::TransitionEvent>(
      node_ + "/transition_event", kQos,
      [this](const ros2::msg::TransitionEvent& event) { set_lifecycle(event.goal_state.id); });
  if (transitions) transitions_ = std::move(*transitions);
  auto client = self_.create_client<ros2::srv::GetState>(node_ + "/get_state");
  if (!client) return;
  state_ = std::move(*client);
  state_->call({}, ros2::Repeat::kUntilAnswered, kAnswerPatience,
               [this](const ros2::Client<ros2::srv::GetState>::Answer& answer) {
                 if (answer.response) set_lifecycle(answer.response->current_state.id);
               });
}

void NodeReading::set_lifecycle(std::uint8_t state) {
  const auto known = ros2::lifecycle_states();
  const auto found = std::find(known.begin(), known.end(), static_cast<LifecycleState>(state));
  const MutexLock lock(mutex_);
  told_.lifecycle = found == known.end() ? "" : ros2::label_of(*found);
}

}  // namespace culprit::link
