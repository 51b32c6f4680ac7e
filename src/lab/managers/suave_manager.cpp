#include "managers/suave_manager.h"

#include <algorithm>
#include <array>

#include "exemplars/suave/model/vehicle.h"
#include "managers/bt_manager.h"
#include "managers/metacontrol_manager.h"
#include "managers/random_manager.h"
#include "managers/rebet_manager.h"
#include "managers/rosa_manager.h"

namespace culprit::study {
namespace {

using suave::model::Leader;

RuleSet make_names() {
  namespace model = suave::model;
  RuleSet names;
  const auto component = [&](const char* name, const char* node) {
    names.components.push_back({name, node, {}, true});
  };
  component("search", model::systems::kSearch);
  component("follow", model::systems::kFollow);
  component("motion", model::systems::kMotion);
  component("recharge", model::systems::kRecharge);
  component("search_node", model::nodes::kSearch);
  component("follow_node", model::nodes::kFollow);
  component("motion_node", model::nodes::kMotion);
  component("recharge_node", model::nodes::kRecharge);

  const auto diagnostic = [&](const std::string& name, std::string key) {
    names.signals.push_back({name, DiagnosticKey{"*", std::move(key)}, {}, {}, {}});
  };
  diagnostic("visibility", std::string(model::diagnostics::kVisibilityKey));
  diagnostic("battery", std::string(model::diagnostics::kBatteryKey));
  for (int n = 1; n <= model::kThrusters; ++n) {
    const std::string number = std::to_string(n);
    diagnostic("thruster_" + number, std::string(model::diagnostics::kThrusterKey) + number);
  }
  const auto topic = [&](const char* name, const char* ros_name) {
    names.topics.push_back({ros_name});
    names.signals.push_back(
        {name, TopicField{TopicId(names.topics.size() - 1), "data"}, {}, {}, {}});
  };
  topic("guided", "/mavros/guided");
  topic("task", "/mission_node/task");
  topic("detected", "/pipeline/detected");
  topic("recharged", "/battery_monitor/recharge/complete");
  return names;
}

// The mission does all there is.
class NoManager : public ManagingSystem {
 public:
  std::vector<Command> step(Time, std::span<const Observation>) override { return {}; }
  Time next_deadline() const override { return kNever; }
  std::span<const Event> events() const override { return {}; }
};

template <class Manager>
std::unique_ptr<ManagingSystem> make(const SuaveManager::Setting& setting) {
  return std::make_unique<Manager>(setting);
}

enum class RebetVariant : std::uint8_t { kInternal, kUcb, kGreedy, kRandom, kThompson };

template <RebetVariant variant>
std::unique_ptr<ManagingSystem> make_rebet(const SuaveManager::Setting& setting) {
  std::optional<BanditPolicy> policy;
  if (variant == RebetVariant::kUcb) policy = BanditPolicy::kUcb;
  if (variant == RebetVariant::kGreedy) policy = BanditPolicy::kGreedy;
  if (variant == RebetVariant::kRandom) policy = BanditPolicy::kRandom;
  if (variant == RebetVariant::kThompson) policy = BanditPolicy::kThompson;
  const auto reward = variant == RebetVariant::kThompson ? RebetManager::Reward::kStrip
                                                         : RebetManager::Reward::kConstant;
  return std::make_unique<RebetManager>(setting, policy, reward);
}

constexpr std::array kBaselines = {
    SuaveBaseline{"none", "nothing is adapted", Leader::kMission,
                  [](const SuaveManager::Setting&) -> std::unique_ptr<ManagingSystem> {
                    return std::make_unique<NoManager>();
                  }},
    SuaveBaseline{"random", "any mode, every now and then", Leader::kBridge, make<RandomManager>},
    SuaveBaseline{"bt", "a behaviour tree", Leader::kManager, make<BtManager>},
    SuaveBaseline{"metacontrol", "MROS: an ontology that is reasoned over periodically",
                  Leader::kBridge, make<MetacontrolManager>},
    SuaveBaseline{"rosa", "ROSA: a knowledge base that plans on every message", Leader::kManager,
                  make<RosaManager>},
    SuaveBaseline{"rebet", "ReBeT: decorators of a behaviour tree", Leader::kManager,
                  make_rebet<RebetVariant::kInternal>},
    SuaveBaseline{"rebet-ucb", "ReBeT with its UCB", Leader::kManager,
                  make_rebet<RebetVariant::kUcb>},
    SuaveBaseline{"rebet-greedy", "ReBeT with its greedy bandit", Leader::kManager,
                  make_rebet<RebetVariant::kGreedy>},
    SuaveBaseline{"rebet-random", "ReBeT with any altitude", Leader::kManager,
                  make_rebet<RebetVariant::kRandom>},
    SuaveBaseline{"bandit", "Thompson sampling of the altitude", Leader::kManager,
                  make_rebet<RebetVariant::kThompson>},
};

}  // namespace

const RuleSet& suave_names() {
  static const RuleSet kNames = make_names();
  return kNames;
}

std::span<const SuaveBaseline> suave_baselines() { return kBaselines; }

std::string SuaveManager::task() const {
  const Value* task = latest("task");
  return task == nullptr ? "" : std::get<std::string>(*task);
}

Routine SuaveManager::change_mode(std::string system, std::string mode, bool* is_done) {
  const Request request = ChangeMode{mode};
  const Reply reply = co_await ask(system, request, kServiceTimeout);
  if (is_done != nullptr) *is_done = reply.outcome == Outcome::kDone;
}

// A thruster has failed until it is said to be recovered; "ERROR" and "OK" repeat what was said.
void SuaveManager::on_signal(const std::string& name, const Value& value) {
  if (!name.starts_with("thruster_")) return;
  if (value == Value(std::string(suave::model::diagnostics::kFailed))) thrusters_[name] = true;
  if (value == Value(std::string(suave::model::diagnostics::kRecovered))) thrusters_[name] = false;
  failed_thrusters_ = std::count_if(thrusters_.begin(), thrusters_.end(),
                                    [](const auto& thruster) { return thruster.second; });
}

}  // namespace culprit::study
