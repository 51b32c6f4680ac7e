// t03: a planner of your own behind its port (plan/planner.h).
//
// A planner is asked about all failures that wait for a decision, and knows what the manager knows.
// This one takes each rule's strategies in the order in which they are written. The
// governor still checks each choice (execute/governor.h).
#include <cstdio>
#include <map>
#include <utility>

#include "knowledge/describe.h"
#include "language/checker.h"
#include "manager/manager.h"

using namespace culprit;
using namespace std::chrono_literals;

namespace {

constexpr const char* kRules = R"(
COMPONENT camera NODE /camera
SIGNAL blur TOPIC /blur FIELD data

RULE PictureBlurred
  POLICIES WARNING
  TRIGGER blur > 0.5
    STRATEGY autofocus 10 10
      ADAPTATION camera set_parameter autofocus true 2
    STRATEGY short_exposure 90 10
      ADAPTATION camera set_parameter exposure 0.01 2
)";

class AsWritten : public Planner {
 public:
  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override {
    std::vector<Decision> decisions;
    for (const RuleId rule : failures) {
      Decision decision{.rule = rule, .chosen = {}, .candidates = {}};
      for (const StrategyId strategy : knowledge.rules[rule].strategies) {
        Candidate candidate;
        candidate.strategy = strategy;
        if (knowledge.states.is_tried(strategy)) {
          candidate.excluded = Condition::kTried;
        } else if (decision.chosen) {
          candidate.excluded = Condition::kOneEach;
        } else {
          decision.chosen = strategy;
        }
        decision.candidates.push_back(std::move(candidate));
      }
      decision.is_spent = !decision.chosen;
      decisions.push_back(std::move(decision));
    }
    return decisions;
  }
};

}  // namespace

int main() {
  const Checked checked = check(Source("camera.rules", kRules));
  if (!checked.rules) return 1;
  const RuleSet& rules = *checked.rules;
  Manager::Options options;
  options.discovery = 1s;
  Manager manager(rules, std::make_unique<AsWritten>(), options);

  // A camera whose picture is sharp with a short exposure, whatever its focus.
  bool is_sharp = false;
  std::map<std::string, Value> parameters;
  std::vector<Observation> observed = {{Time{}, NodeAppeared{"/camera"}}};
  for (Time now{}; now < Time(10s); now += 100ms) {
    observed.push_back({now, SignalRead{SignalId(0), Value(is_sharp ? 0.1 : 0.9)}});
    const std::vector<Observation> all = std::exchange(observed, {});
    for (const Command& command : manager.step(now, all)) {
      Reply reply{command.id, Outcome::kDone, Value(false), ""};
      if (const auto* set = std::get_if<SetParameter>(&command.what)) {
        is_sharp = set->name == "exposure";
        parameters[set->name] = set->value;
      }
      if (const auto* read = std::get_if<ReadParameter>(&command.what)) {
        const auto found = parameters.find(read->name);
        if (found != parameters.end()) reply.value = found->second;
      }
      observed.push_back({now, reply});
    }
    for (const Event& event : manager.events()) {
      const std::string text = describe(event, rules);
      if (!text.empty()) std::printf("%5.1f s %s\n", seconds(now.time_since_epoch()), text.c_str());
    }
  }
  return is_sharp ? 0 : 1;
}
