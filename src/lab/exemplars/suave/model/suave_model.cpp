#include "exemplars/suave/model/suave_model.h"

namespace culprit::suave::model {
namespace {

using std::chrono::milliseconds;

// By then everything runs, and observers have discovered it.
constexpr double kBeginSec = 10;

Time draw_begin(simulation::Random random) {
  return Time{from_seconds(kBeginSec + random.uniform())};
}

simulation::NodeTraits mode_manager() {
  simulation::NodeTraits traits;
  traits.start = {milliseconds(300), milliseconds(400)};
  traits.end = {milliseconds(10), milliseconds(40)};
  traits.service = {std::chrono::microseconds(500), milliseconds(2)};
  return traits;
}

// A plan that says where it begins leaves nothing of that to chance.
VehicleTraits started_at(VehicleTraits traits, const MissionPlan& plan) {
  if (!plan.start_y_m) return traits;
  traits.centre_y = *plan.start_y_m;
  traits.centre_y_sd = 0;
  return traits;
}

}  // namespace

SuaveModel::SuaveModel(const Setting& setting, std::uint64_t seed)
    : plan_(setting.plan),
      world_(seed),
      topics_(world_),
      autopilot_(world_, topics_, started_at(setting.vehicle, setting.plan),
                 draw_begin(world_.random("begin"))),
      detector_(world_, topics_, setting.generation, autopilot_),
      visibility_(world_, autopilot_, setting.plan),
      battery_(world_, topics_, autopilot_, setting.plan),
      thrusters_(world_, autopilot_, setting.plan),
      search_(world_, setting.generation, *this),
      follow_(world_, topics_, setting.generation, *this),
      motion_(world_, setting.generation, *this),
      recharge_(world_, setting.generation, *this),
      modes_(world_, nodes::kModeManager, mode_model(), mode_manager()),
      mission_(world_, topics_, setting.generation, setting.plan, setting.leader,
               autopilot_.guided(), *this),
      metrics_(world_, topics_) {
  mission_.change_mode = [this](const char* system, const char* mode) {
    world_.after(modes_.traits().service.draw(mission_.random()), [this, system, mode] {
      modes_.post([this, system, mode] { (void)modes_.change_mode(system, mode); });
    });
  };
  for (simulation::Node* node : world_.nodes()) node->launch();
  for (simulation::Fault fault : plan_.faults) {
    fault.at = later(guided(), fault.at.time_since_epoch());
    // The plans' faults are of nodes that the model has.
    (void)simulation::inject(world_, fault);
  }
}

Time SuaveModel::latest_end() const {
  return later(guided(), plan_.time_limit + std::chrono::seconds(1));
}

}  // namespace culprit::suave::model
