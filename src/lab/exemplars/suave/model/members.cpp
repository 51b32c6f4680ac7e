#include "exemplars/suave/model/members.h"

namespace culprit::suave::model {
namespace {

constexpr simulation::Transport kSmall{{std::chrono::microseconds(300), {}}, 0};

}  // namespace

std::optional<Value> field_of(const Data& message, std::string_view field) {
  if (field != "data") return std::nullopt;
  return message.data;
}

Topics::Topics(simulation::World& world)
    : guided(world, "/mavros/guided", kSmall),
      task(world, "/mission_node/task", kSmall),
      detected(world, "/pipeline/detected", kSmall),
      distance(world, "/pipeline/distance_inspected", kSmall),
      inspected(world, "/pipeline/inspected", kSmall),
      recharged(world, "/battery_monitor/recharge/complete", kSmall) {}

}  // namespace culprit::suave::model
