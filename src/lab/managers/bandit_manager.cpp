#include "managers/bandit_manager.h"

#include <algorithm>
#include <array>

#include "managers/style_planner.h"

namespace culprit::study {
namespace {

constexpr std::array kBandits = {
    BanditKind{"rebet-ucb", BanditPolicy::kUcb, false},
    BanditKind{"rebet-greedy", BanditPolicy::kGreedy, false},
    BanditKind{"rebet-random", BanditPolicy::kRandom, false},
    BanditKind{"bandit", BanditPolicy::kThompson, false},
    BanditKind{"random", BanditPolicy::kRandom, true},
};

bool is_under_way(const Knowledge& knowledge) {
  const auto& active = knowledge.states.active();
  return std::any_of(active.begin(), active.end(),
                     [&](RuleId id) { return knowledge.states[id].attempt.has_value(); });
}

Decision waiting(RuleId rule, const Knowledge& knowledge) {
  Decision decision;
  decision.rule = rule;
  for (const StrategyId id : knowledge.rules[rule].strategies) {
    Candidate& candidate = decision.candidates.emplace_back();
    candidate.strategy = id;
    candidate.excluded = Condition::kAdapting;
    candidate.component = knowledge.rules[id].components.front();
  }
  return decision;
}

}  // namespace

struct BanditManager::Memory {
  const BanditKind& kind;
  BanditExperience experience;
  simulation::Random random;

  std::vector<StrategyId> ranking(const Rule& rule) {
    std::vector<BanditArm> arms;
    for (const StrategyId id : rule.strategies) arms.push_back(experience[id.index]);
    std::vector<StrategyId> order;
    for (const std::size_t i : ranked(kind.policy, arms, random))
      order.push_back(rule.strategies[i]);
    return order;
  }
};

namespace {

// Memory is the manager's own; a planner only decides by it.
template <class Memory>
class BanditPlanner : public Planner {
 public:
  explicit BanditPlanner(Memory& memory)
      : memory_(memory),
        planner_(Style::kRebet, [&memory](const Rule& rule) { return memory.ranking(rule); }) {}

  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override {
    if (!memory_.kind.is_one_at_a_time) return planner_.plan(failures, knowledge);
    std::vector<Decision> decisions;
    if (failures.empty()) return decisions;
    const auto turn =
        static_cast<std::size_t>(memory_.random.below(static_cast<int>(failures.size())));
    const bool is_busy = is_under_way(knowledge);
    for (std::size_t i = 0; i < failures.size(); ++i) {
      if (is_busy || i != turn) {
        decisions.push_back(waiting(failures[i], knowledge));
      } else {
        decisions.push_back(planner_.plan(failures.subspan(i, 1), knowledge).front());
      }
    }
    return decisions;
  }

 private:
  Memory& memory_;
  StylePlanner planner_;
};

}  // namespace

const BanditKind* find_bandit(std::string_view name) {
  const auto found = std::find_if(kBandits.begin(), kBandits.end(),
                                  [&](const BanditKind& each) { return each.name == name; });
  return found == kBandits.end() ? nullptr : &*found;
}

BanditExperience no_experience(const RuleSet& rules) {
  BanditExperience experience;
  for (const Strategy& strategy : rules.strategies) {
    const Belief belief = initial_belief(strategy.success, strategy.confidence);
    experience.push_back({belief.alpha, belief.beta});
  }
  return experience;
}

BanditManager::BanditManager(const RuleSet& rules, const BanditKind& kind,
                             BanditExperience experience, std::uint64_t seed,
                             Manager::Options options)
    : memory_(new Memory{kind, std::move(experience), simulation::Random(seed)}),
      manager_(rules, std::make_unique<BanditPlanner<Memory>>(*memory_), std::move(options)) {}

BanditManager::~BanditManager() = default;

std::vector<Command> BanditManager::step(Time now, std::span<const Observation> observations) {
  std::vector<Command> commands = manager_.step(now, observations);
  for (const Event& event : manager_.events()) {
    if (const auto* failed = std::get_if<StrategyFailed>(&event.what))
      memory_->experience[failed->strategy.index].add(0);
    const auto* resolved = std::get_if<FailureResolved>(&event.what);
    if (resolved != nullptr && resolved->how == FailureResolved::How::kByStrategy &&
        resolved->strategy)
      memory_->experience[resolved->strategy->index].add(1);
  }
  return commands;
}

Time BanditManager::next_deadline() const { return manager_.next_deadline(); }
std::span<const Event> BanditManager::events() const { return manager_.events(); }
const BanditExperience& BanditManager::experience() const { return memory_->experience; }

}  // namespace culprit::study
