#include "ros_api/teller.h"

#include <algorithm>

#include "ros_api/decision_message.h"
#include "web/component_health.h"
#include "web/overview.h"

namespace culprit::ros_api {
namespace {

constexpr std::string_view kComponentType = "culprit_msgs/msg/Component";

// Samples and values come at the rate of the robot's topics; events report their meaning.
bool may_change_status(const Observation& observation) {
  const auto& what = observation.what;
  const auto* reply = std::get_if<Reply>(&what);
  return (reply != nullptr && std::holds_alternative<Lifecycle>(reply->value)) ||
         std::holds_alternative<NodeAppeared>(what) || std::holds_alternative<NodeVanished>(what) ||
         std::holds_alternative<ProcessSeen>(what) || std::holds_alternative<LifecycleRead>(what) ||
         std::holds_alternative<NamesakesSeen>(what) || std::holds_alternative<Order>(what) ||
         std::holds_alternative<HearingLost>(what) || std::holds_alternative<HearingRegained>(what);
}

std::string process_of(const ComponentState& state) {
  if (!state.alive) return "PROCESS_UNKNOWN";
  if (state.process == ProcessState::kStopped) return "PROCESS_STOPPED";
  if (state.hangs()) return "PROCESS_HUNG";
  return *state.alive ? "PROCESS_RUNNING" : "PROCESS_GONE";
}

bool is_silenced(const Silenceable& what, const Governor& governor) {
  return std::ranges::any_of(governor.silences(),
                             [&](const auto& each) { return each.what == what; });
}

std::string summary_of(const Manager& manager) {
  const std::string text = web::overview_of(manager).headline;
  return manager.governor().is_paused() ? text + " [paused]" : text;
}

// A field that changes with the time alone is no news.
Json without_times(Json status) {
  status.erase("stamp");
  for (Json& incident : status["incidents"]) {
    incident.erase("stamp");
    incident.erase("next");
  }
  return status;
}

}  // namespace

void Teller::begins(const Manager& manager, std::function<Remarks()> remarks, Time) {
  manager_ = &manager;
  remarks_ = std::move(remarks);
  // The new node has published nothing yet.
  told_ = nullptr;
  may_have_changed_ = true;
  is_new_manager_ = true;
  looked_ = kLongAgo;
}

void Teller::stepped(const Runtime::Step& step) {
  const std::vector<Json> closed = incidents_.note(step.events, wall_());
  tell_decisions(step.events, step.now);
  if (std::exchange(is_new_manager_, false) || !step.events.empty() || incidents_.due() <= step.now)
    tell_incidents(step.now);
  for (const Json& message : closed) tell_(Topic::kIncidents, message);
  may_have_changed_ |=
      !step.events.empty() || std::ranges::any_of(step.observations, may_change_status);
  if (may_have_changed_ && step.now >= later(looked_, kPeriod)) tell_status(step.now);
}

Time Teller::next_look() const {
  const Time status = may_have_changed_ ? later(looked_, kPeriod) : kNever;
  return std::min(status, incidents_.due());
}

void Teller::tell_decisions(std::span<const Event> events, Time now) {
  if (now >= later(second_, std::chrono::seconds(1))) {
    second_ = now;
    decisions_ = 0;
  }
  for (const Event& event : events) {
    auto message = decision_message(event, manager_->knowledge().rules, types_, wall_());
    if (!message) continue;
    if (decisions_ >= kMostDecisions) {
      ++left_out_;
      continue;
    }
    ++decisions_;
    (*message)["left_out"] = std::exchange(left_out_, 0);
    tell_(Topic::kDecisions, *message);
  }
}

void Teller::tell_incidents(Time now) {
  for (const Json& message : incidents_.look(*manager_, now, wall_()))
    tell_(Topic::kIncidents, message);
}

void Teller::tell_status(Time now) {
  may_have_changed_ = false;
  looked_ = now;
  Json message = status();
  Json as_told = without_times(message);
  if (as_told == told_) return;
  told_ = std::move(as_told);
  tell_(Topic::kStatus, message);
}

Json Teller::status() const {
  const Knowledge& knowledge = manager_->knowledge();
  const RuleSet& rules = knowledge.rules;
  const Governor& governor = manager_->governor();
  const std::vector<Json> incidents = incidents_.open();
  int health = types_.constant(kComponentType, "HEALTH_OK");
  for (const Json& each : incidents) health = std::max(health, each["health"].get<int>());
  Json message{{"stamp", stamp_of(wall_())},
               {"robot", rules.robot},
               {"version", version_},
               {"health", health},
               {"summary", summary_of(*manager_)},
               {"hears", manager_->hears()},
               {"is_paused", governor.is_paused()},
               {"advises", manager_->autonomy() == Autonomy::kAdvise},
               {"components", Json::array()},
               {"incidents", incidents},
               {"asked", Json::array()},
               {"silenced_rules", Json::array()}};
  const std::vector<std::size_t> healths = web::health_of_components(knowledge);
  const Remarks remarks = remarks_ ? remarks_() : Remarks();
  for (std::size_t c = 0; c < rules.components.size(); ++c)
    message["components"].push_back(component(ComponentId(c), healths[c], remarks));
  for (const StrategyId id : governor.asked())
    message["asked"].push_back(strategy_message(id, rules));
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    if (is_silenced(RuleId(r), governor)) message["silenced_rules"].push_back(rules.rules[r].name);
  }
  return message;
}

Json Teller::component(ComponentId id, std::size_t health, const Remarks& remarks) const {
  const Knowledge& knowledge = manager_->knowledge();
  const ComponentState& state = knowledge.components[id];
  const std::string& seen = knowledge.graph.node_name(id);
  const std::string& node = seen.empty() ? knowledge.rules[id].node : seen;
  const Attempt* attempt = knowledge.states.reservation(id);
  const auto remark = remarks.find(node);
  const std::string word(web::kHealthWords[health]);
  return {{"name", knowledge.rules[id].name},
          {"node", node},
          {"health", types_.constant(kComponentType, "HEALTH_" + word)},
          {"is_present", knowledge.graph.is_present(id)},
          {"process", types_.constant(kComponentType, process_of(state))},
          {"lifecycle",
           state.lifecycle == Lifecycle::kUnknown ? "" : std::string(to_string(state.lifecycle))},
          {"adapting", attempt == nullptr ? "" : knowledge.rules[attempt->strategy].name},
          {"is_silenced", is_silenced(id, manager_->governor())},
          {"remark", remark == remarks.end() ? state.process_remark : remark->second}};
}

}  // namespace culprit::ros_api
