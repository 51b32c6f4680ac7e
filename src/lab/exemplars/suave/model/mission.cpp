#include "exemplars/suave/model/mission.h"

#include "exemplars/suave/model/visibility.h"

namespace culprit::suave::model {
namespace {

simulation::SystemMode mode(const char* name, const char* node, bool is_active,
                            std::map<std::string, Value> parameters = {}) {
  return {name, {{node, is_active, std::move(parameters)}}};
}

}  // namespace

std::vector<simulation::ModeSystem> mode_systems() {
  using namespace modes;
  simulation::ModeSystem search{
      systems::kSearch,
      {mode(kDefault, nodes::kSearch, true, {{kAltitude, kSearchModes.back().altitude}})}};
  for (const SearchMode& each : kSearchModes)
    search.modes.push_back(mode(each.name, nodes::kSearch, true, {{kAltitude, each.altitude}}));
  search.modes.push_back(mode(kOff, nodes::kSearch, false));
  return {std::move(search),
          {systems::kFollow,
           {mode(kDefault, nodes::kFollow, false), mode(kOff, nodes::kFollow, false),
            mode(kFollow, nodes::kFollow, true)}},
          {systems::kMotion,
           {mode(kDefault, nodes::kMotion, true), mode(kRecover, nodes::kMotion, true),
            mode(kAllThrusters, nodes::kMotion, false), mode(kOff, nodes::kMotion, false)}},
          {systems::kRecharge,
           {mode(kDefault, nodes::kRecharge, false), mode(kNoRecharge, nodes::kRecharge, false),
            mode(kOff, nodes::kRecharge, false), mode(kRecharge, nodes::kRecharge, true)}}};
}

Mission::Mission(simulation::World& world, Topics& topics, const Generation& generation,
                 const MissionPlan& plan, Leader leader, Time guided, const Helm& helm)
    : Node(world, nodes::kMission, {}),
      generation_(generation),
      plan_(plan),
      leader_(leader),
      guided_(guided),
      helm_(helm),
      inspected_topic_(topics.inspected),
      task_topic_(*this, topics.task, simulation::Use::kAlways) {
  inspected_topic_.set_watched(true);
  inspected_topic_.watch_field("data");
  world.watch(*this);
}

Mission::~Mission() { world().unwatch(*this); }

void Mission::on_start() {
  world().at(guided_, [this] { begin(); });
}

void Mission::begin() {
  constexpr Duration kTimePoll = std::chrono::milliseconds(500);
  every(from_seconds(seconds(kTimePoll) * random().uniform()), kTimePoll, [this] {
    if (world().now() >= later(guided_, plan_.time_limit)) end();
  });
  if (leader_ == Leader::kManager) return;
  begin_task("search");
  ground(systems::kSearch, kSearchModes.back().name);
  every(generation_.detection_poll, [this] { poll(); });
}

void Mission::poll() {
  if (is_inspecting_ || !helm_.found()) return;
  is_inspecting_ = true;
  ground(systems::kSearch, modes::kOff);
  begin_task("inspect");
  ground(systems::kFollow, modes::kFollow);
}

void Mission::begin_task(const char* task) { task_topic_.publish({std::string(task)}); }

void Mission::ground(const char* system, const char* mode) {
  if (leader_ == Leader::kMission) change_mode(system, mode);
}

// Whoever leads: what is inspected wholly is done.
void Mission::on_field(const simulation::TopicBase& topic, const std::string&, const Value&) {
  if (&topic == &inspected_topic_) end();
}

void Mission::end() {
  if (ended_) return;
  ended_ = world().now();
  if (on_end) on_end();
}

}  // namespace culprit::suave::model
