// t01: the manager inside a program of your own.
//
// The manager is a pure state machine. It is told what was observed and what time it is, and says
// what is to be done; the program carries that out and tells what came of it. Here everything is
// done by hand, for a tank whose pump is too slow.
#include <algorithm>
#include <cstdio>
#include <deque>

#include "knowledge/describe.h"
#include "language/checker.h"
#include "manager/manager.h"
#include "plan/bayes/bayes_planner.h"

using namespace culprit;
using namespace std::chrono_literals;

namespace {

constexpr const char* kRules = R"(
COMPONENT pump NODE /pump
SIGNAL level TOPIC /level FIELD data

RULE TankRunsDry
  POLICIES ERROR
  TRIGGER level < 0.2
    STRATEGY faster 80 10
      ADAPTATION pump set_parameter speed 3.0 5
)";

// The robot: the tank fills if the pump is fast enough.
struct Tank {
  double speed = 1;
  double level = 0.5;

  void pass(double seconds) { level = std::clamp(level + (speed - 2) * 0.1 * seconds, 0.0, 1.0); }
  Reply carry_out(const Command& command) {
    std::printf("        asked: %s\n", to_string(command).c_str());
    if (const auto* set = std::get_if<SetParameter>(&command.what))
      speed = std::get<double>(set->value);
    return {command.id, Outcome::kDone, Value(speed), ""};
  }
};

}  // namespace

int main() {
  const Checked checked = check(Source("tank.rules", kRules));
  if (!checked.rules) return 1;
  const RuleSet& rules = *checked.rules;

  Manager::Options options;
  options.discovery = 1s;  // until then nothing is called missing
  Manager manager(rules, std::make_unique<BayesPlanner>(), options);

  Tank tank;
  std::deque<Observation> observed = {{Time{}, NodeAppeared{"/pump"}}};
  for (Time now{}; now < Time(10s); now += 100ms) {
    tank.pass(0.1);
    observed.push_back({now, SignalRead{SignalId(0), Value(tank.level)}});
    const std::vector<Observation> all(observed.begin(), observed.end());
    observed.clear();
    for (const Command& command : manager.step(now, all))
      observed.push_back({now, tank.carry_out(command)});
    for (const Event& event : manager.events()) {
      const std::string text = describe(event, rules);
      if (!text.empty()) std::printf("%5.1f s %s\n", seconds(now.time_since_epoch()), text.c_str());
    }
  }
  std::printf("the level is %.1f\n", tank.level);
  return tank.level > 0.5 ? 0 : 1;
}
