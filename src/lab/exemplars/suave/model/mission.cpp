#include "exemplars/suave/model/mission.h"

#include "exemplars/suave/model/visibility.h"

namespace culprit::suave::model {
namespace {

namespace system_modes = culprit::modes;

const system_modes::Target kInactive{false, ""};
const system_modes::Target kActive{true, modes::kDefault};

// A node with one mode, for it has no parameters to set.
system_modes::Entity plain_node(const char* name) {
  system_modes::Entity node;
  node.name = name;
  node.modes = {{modes::kDefault, {}, {}}};
  return node;
}

system_modes::Entity search_node() {
  system_modes::Entity node;
  node.name = nodes::kSearch;
  const auto add = [&](const char* mode, double altitude) {
    node.modes.push_back({mode, {}, {{kAltitude, altitude}}});
  };
  add(modes::kDefault, kSearchModes.back().altitude);
  for (const SearchMode& each : kSearchModes) add(each.name, each.altitude);
  return node;
}

// A system of one part, with what each mode wants of it.
system_modes::Entity system_of(const char* name, const char* node,
                               std::vector<std::pair<const char*, system_modes::Target>> wanted) {
  system_modes::Entity system;
  system.name = name;
  system.is_system = true;
  system.parts = {node};
  for (auto& [mode, target] : wanted) system.modes.push_back({mode, {{node, target}}, {}});
  return system;
}

system_modes::Entity search_system() {
  std::vector<std::pair<const char*, system_modes::Target>> wanted{{modes::kDefault, kActive}};
  for (const SearchMode& each : kSearchModes) wanted.push_back({each.name, {true, each.name}});
  wanted.push_back({modes::kOff, kInactive});
  return system_of(systems::kSearch, nodes::kSearch, std::move(wanted));
}

}  // namespace

system_modes::Model mode_model() {
  using namespace modes;
  return {{plain_node(nodes::kFollow), search_node(), plain_node(nodes::kMotion),
           plain_node(nodes::kRecharge), search_system(),
           system_of(systems::kFollow, nodes::kFollow,
                     {{kDefault, kInactive}, {kOff, kInactive}, {modes::kFollow, kActive}}),
           system_of(systems::kMotion, nodes::kMotion,
                     {{kDefault, kActive},
                      {kRecover, kActive},
                      {kAllThrusters, kInactive},
                      {kOff, kInactive}}),
           system_of(systems::kRecharge, nodes::kRecharge,
                     {{kDefault, kInactive},
                      {kNoRecharge, kInactive},
                      {kOff, kInactive},
                      {modes::kRecharge, kActive}})}};
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

// The mission is over once the whole pipeline is inspected, in every mode of leading.
void Mission::on_field(const simulation::TopicBase& topic, const std::string&, const Value&) {
  if (&topic == &inspected_topic_) end();
}

void Mission::end() {
  if (ended_) return;
  ended_ = world().now();
  if (on_end) on_end();
}

}  // namespace culprit::suave::model
