#include "exemplars/suave/model/mission_plan.h"

#include <array>
#include <string>

#include "exemplars/suave/model/members.h"

namespace culprit::suave::model {
namespace {

using namespace std::chrono_literals;

Generation era() {
  Generation g;
  g.name = "era";
  g.summary = "versions 1.3 and 1.4, on which the published figures were measured";
  g.pipeline_height = 0.75;
  g.detection_poll = 1s;
  g.recharge_poll = 5s;
  return g;
}

Generation newest() {
  Generation g;
  g.name = "new";
  g.summary = "version 1.5";
  g.detection_poll = 100ms;
  g.recharge_poll = 500ms;
  g.tells_undetected = true;
  g.keeps_spiral = false;
  g.loses_point = false;
  g.recovers_anyway = false;
  return g;
}

MissionPlan standard() {
  MissionPlan plan;
  plan.name = "standard";
  plan.summary = "the water gets murky, and a thruster fails";
  plan.thruster_events = {{1, true, 35s}};
  return plan;
}

MissionPlan extended() {
  MissionPlan plan = standard();
  plan.name = "extended";
  plan.summary = "the standard mission, and the battery runs low";
  plan.needs_battery = true;
  return plan;
}

// Faults that come together and on top of each other: the search dies; the mode manager hangs just
// before the first thruster fails, so that no mode can be changed; a second thruster fails when the
// water begins to clear; later whatever follows the pipeline dies; and an empty battery is the end.
MissionPlan stress() {
  MissionPlan plan = extended();
  plan.name = "stress";
  plan.summary =
      "two thrusters, a dead search, a hung mode manager, a dead inspection, a battery "
      "that must not run empty";
  plan.thruster_events.push_back({3, true, 66s});
  plan.stops_when_empty = true;
  plan.faults = {{Time{20s}, nodes::kSearch, simulation::Killed{}},
                 {Time{34s}, nodes::kModeManager, simulation::Hung{}},
                 {Time{120s}, nodes::kFollow, simulation::Killed{}}};
  return plan;
}

// Gives the one of this name, or an error that says which there are.
template <class T>
Expected<const T*> find(std::span<const T> all, std::string_view name, std::string_view kind) {
  std::string known;
  for (const T& each : all) {
    if (each.name == name) return &each;
    known += (known.empty() ? "" : ", ") + std::string(each.name);
  }
  return Error{"there is no " + std::string(kind) + " '" + std::string(name) + "'; there are " +
               known};
}

}  // namespace

std::span<const Generation> generations() {
  static const std::array kGenerations = {era(), newest()};
  return kGenerations;
}

Expected<const Generation*> find_generation(std::string_view name) {
  return find(generations(), name, "generation of SUAVE");
}

std::span<const MissionPlan> mission_plans() {
  static const std::array kPlans = {standard(), extended(), stress()};
  return kPlans;
}

Expected<const MissionPlan*> find_mission_plan(std::string_view name) {
  return find(mission_plans(), name, "mission of SUAVE");
}

}  // namespace culprit::suave::model
