#include "torture/torture.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <utility>

#include "knowledge/describe.h"
#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"
#include "plan/paper_planner.h"
#include "torture/tortured_robot.h"

namespace culprit::torture {
namespace {

using namespace std::chrono_literals;
using Kind = Mishap::Kind;

constexpr Time kQuiet{21s};    // what happens by itself is over by then, the noise too
constexpr Time kLatest{900s};  // back-offs, attempts and silences are over by then
constexpr Duration kCalm = 4s;

// A step of a manager as it was recorded.
struct Step {
  Time now;
  std::vector<Observation> observations;
  std::vector<std::string> said;
};

std::string in_words(const Command& command, const RuleSet& rules) {
  return rules[command.component].name + " <- " + to_string(command);
}

std::vector<std::string> words_of(const Manager& manager, std::span<const Command> commands,
                                  const RuleSet& rules) {
  std::vector<std::string> words;
  for (const Event& event : manager.events()) {
    std::string line = describe(event, rules);
    if (!line.empty()) words.push_back(std::move(line));
  }
  for (const Command& command : commands) words.push_back(in_words(command, rules));
  return words;
}

class Run {
 public:
  explicit Run(const Scenario& scenario)
      : scenario_(scenario),
        rules_(*check(Source("torture.rules", rules_of(scenario))).rules),
        robot_(scenario_, rules_),
        invariants_(rules_, scenario) {
    begin_manager();
  }

  RunOutcome go() {
    std::size_t next = 0;
    while (robot_.now() < kLatest && !invariants_.violation()) {
      // In the world's order; the manager's clock may be ahead of it.
      while (next < scenario_.mishaps.size() && scenario_.mishaps[next].at <= robot_.now()) {
        befall(scenario_.mishaps[next++]);
        calm_since_ = robot_.now();
      }
      if (robot_.now() >= kQuiet) robot_.end_noise();
      const bool is_over = next == scenario_.mishaps.size() && robot_.now() >= kQuiet;
      if (!is_over || !is_settled()) calm_since_ = robot_.now();
      if (is_over && robot_.now() - calm_since_ >= kCalm) break;
      Time until = std::min(kLatest, manager_->next_deadline());
      if (next < scenario_.mishaps.size()) until = std::min(until, scenario_.mishaps[next].at);
      if (!due_.empty()) until = std::min(until, due_.begin()->first);
      step(std::min(until, robot_.now() + 1s));
    }
    if (!invariants_.violation()) check_liveness();
    if (!outcome_.violation) outcome_.violation = invariants_.violation();
    if (!outcome_.violation) check_replay();
    return std::move(outcome_);
  }

 private:
  std::unique_ptr<Manager> make_manager(Time start) const {
    Manager::Options options;
    options.start = start;
    options.settling = 3s;
    options.governor = scenario_.governor;
    std::unique_ptr<const Planner> planner = std::make_unique<BayesPlanner>();
    if (scenario_.uses_paper_planner) planner = std::make_unique<PaperPlanner>();
    return std::make_unique<Manager>(rules_, std::move(planner), options);
  }

  // Its beliefs and what it saw of the robot outlive a crash; the rest it has to find out anew.
  void begin_manager() {
    std::vector<Belief> beliefs;
    for (std::size_t s = 0; manager_ && s < rules_.strategies.size(); ++s)
      beliefs.push_back(manager_->knowledge().beliefs[StrategyId(s)]);
    if (manager_) {
      check_replay();
      known_ = manager_->knowledge().known_robot();
    }
    start_ = robot_.now();
    manager_ = make_manager(start_);
    manager_->remember(known_);
    for (std::size_t s = 0; s < beliefs.size(); ++s)
      manager_->set_belief(StrategyId(s), beliefs[s]);
    first_beliefs_ = beliefs;
    recorded_.clear();
    invariants_.begin(*manager_);
  }

  void befall(const Mishap& mishap) {
    say(describe(mishap), "!");
    const ComponentId component(mishap.part);
    switch (mishap.kind) {
      case Kind::kCrash:
        begin_manager();
        return robot_.rediscover();
      case Kind::kPause:
        order(Pause{});
        due_.emplace(robot_.now() + mishap.lasts, Resume{});
        return;
      case Kind::kSilence:
        return order(Silence{component, mishap.lasts});
      case Kind::kRunByHand:
        return order(RunStrategy{strategy(mishap.part, "redeploy")});
      default:
        robot_.befall(mishap);
    }
  }

  StrategyId strategy(std::size_t part, std::string_view name) const {
    for (std::size_t s = 0; s < rules_.strategies.size(); ++s) {
      const Strategy& strategy = rules_.strategies[s];
      if (strategy.name == name && strategy.components.front() == ComponentId(part))
        return StrategyId(s);
    }
    return {};
  }

  template <class What>
  void order(What what) {
    orders_.push_back({robot_.now(), Order{0, "operator", "", std::move(what)}});
  }

  // Says yes to most, a second later.
  void answer_questions() {
    if (!scenario_.operator_answers) return;
    for (const StrategyId asked : manager_->governor().asked()) {
      const bool is_known = std::any_of(due_.begin(), due_.end(), [&](const auto& due) {
        const auto* yes = std::get_if<Approve>(&due.second);
        const auto* no = std::get_if<Refuse>(&due.second);
        return (yes && yes->strategy == asked) || (no && no->strategy == asked);
      });
      if (is_known) continue;
      const bool is_refused = simulation::mix(scenario_.seed ^ asked.index) % 8 == 0;
      if (is_refused) {
        due_.emplace(robot_.now() + 1s, Refuse{asked});
      } else {
        due_.emplace(robot_.now() + 1s, Approve{asked});
      }
    }
  }

  void step(Time until) {
    std::vector<Observation> observations;
    robot_.observe(until, observations);
    while (!due_.empty() && due_.begin()->first <= robot_.now()) {
      std::visit([&](const auto& what) { order(what); }, due_.begin()->second);
      due_.erase(due_.begin());
    }
    std::move(orders_.begin(), orders_.end(), std::back_inserter(observations));
    orders_.clear();
    const Time now = robot_.now();
    const std::vector<Command> commands = manager_->step(now, observations);
    ++outcome_.steps;
    std::vector<std::string> words = words_of(*manager_, commands, rules_);
    for (const std::string& line : words) say(line, " ");
    for (const Event& event : manager_->events()) {
      const auto* held = std::get_if<ActionHeldBack>(&event.what);
      was_refused_ |= held != nullptr && held->restraint == Restraint::kRefused;
    }
    invariants_.check(*manager_, now, commands, truth());
    recorded_.push_back({now, std::move(observations), std::move(words)});
    for (const Command& command : commands) robot_.execute(command);
    answer_questions();
  }

  Invariants::Truth truth() const {
    Invariants::Truth truth;
    for (std::size_t i = 0; i < scenario_.parts.size(); ++i)
      truth.processes.push_back(robot_.process(i));
    const Duration known = 2 * kPeriod + scenario_.noise.lateness;
    truth.is_moving = scenario_.has_interlock && robot_.has_moved_for(known);
    return truth;
  }

  bool is_settled() const {
    for (std::size_t r = 0; r < rules_.rules.size(); ++r) {
      const RulePhase phase = manager_->knowledge().states[RuleId(r)].phase;
      if (phase != RulePhase::kQuiet && phase != RulePhase::kExhausted) return false;
    }
    return manager_->governor().silences().empty();
  }

  void check_liveness() {
    if (!is_excused()) {
      for (std::size_t i = 0; i < scenario_.parts.size(); ++i) {
        if (!robot_.works(i))
          return fail("c" + std::to_string(i) + " is not cured, and nobody says why");
      }
    }
  }

  // What was said to a person at the end of it all.
  bool is_excused() const {
    const Governor& governor = manager_->governor();
    if (governor.is_paused() || !governor.silences().empty() || !governor.asked().empty() ||
        governor.storm() || was_refused_)
      return true;
    for (std::size_t r = 0; r < rules_.rules.size(); ++r) {
      if (manager_->knowledge().states[RuleId(r)].phase == RulePhase::kExhausted) return true;
    }
    return false;
  }

  void check_replay() {
    const auto again = make_manager(start_);
    again->remember(known_);
    for (std::size_t s = 0; s < first_beliefs_.size(); ++s)
      again->set_belief(StrategyId(s), first_beliefs_[s]);
    for (const Step& recorded : recorded_) {
      const std::vector<Command> commands = again->step(recorded.now, recorded.observations);
      if (words_of(*again, commands, rules_) != recorded.said)
        return fail("the same observations give other decisions");
    }
  }

  void fail(std::string what) {
    if (!outcome_.violation) outcome_.violation = Violation{robot_.now(), std::move(what)};
  }

  void say(const std::string& line, const char* mark) {
    char at[32];
    std::snprintf(at, sizeof at, "%9.3f %s ", seconds(robot_.now().time_since_epoch()), mark);
    outcome_.timeline.push_back(at + line);
  }

  const Scenario scenario_;
  const RuleSet rules_;
  TorturedRobot robot_;
  Invariants invariants_;
  std::unique_ptr<Manager> manager_;
  Time start_{};
  std::vector<Belief> first_beliefs_;
  KnownRobot known_;  // by the managers before this one
  std::vector<Step> recorded_;
  std::vector<Observation> orders_;
  std::multimap<Time, std::variant<Resume, Approve, Refuse>> due_;
  Time calm_since_{};
  bool was_refused_ = false;
  RunOutcome outcome_;
};

}  // namespace

RunOutcome run(const Scenario& scenario) { return Run(scenario).go(); }

}  // namespace culprit::torture
