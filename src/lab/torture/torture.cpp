#include "torture/torture.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "analyze/backoff.h"
#include "journal/history.h"
#include "knowledge/describe.h"
#include "language/checker.h"
#include "manager/runtime.h"
#include "plan/bayes/bayes_planner.h"
#include "plan/paper_planner.h"
#include "torture/memory.h"
#include "torture/tortured_robot.h"

namespace culprit::torture {
namespace {

using namespace std::chrono_literals;
using Kind = Mishap::Kind;

constexpr Time kQuiet{21s};     // the noise is over by then
constexpr Time kLatest{3600s};  // back-offs, attempts and silences are over by then
constexpr Duration kCalm = 4s;
// A manager that reports nothing for this long waits for a person, not for a back-off or a budget.
constexpr Duration kGivenUp = 2 * kLongestBackoff;

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
        memory_(rules_),
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
      const bool is_over = next == scenario_.mishaps.size() && robot_.now() >= over_;
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
    options.discovery = 3s;
    options.governor = scenario_.governor;
    std::unique_ptr<const Planner> planner = std::make_unique<BayesPlanner>();
    if (scenario_.uses_paper_planner) planner = std::make_unique<PaperPlanner>();
    return std::make_unique<Manager>(rules_, std::move(planner), options);
  }

  // The state that a manager begins with.
  struct Beginning {
    Time start{};
    std::vector<Belief> beliefs;
    KnownRobot known_robot;
    History past;
    std::vector<Interrupted> interrupted;
  };

  std::unique_ptr<Manager> make_manager() const {
    auto manager = make_manager(beginning_.start);
    for (std::size_t s = 0; s < beginning_.beliefs.size(); ++s)
      manager->set_belief(StrategyId(s), beginning_.beliefs[s]);
    manager->remember(beginning_.known_robot);
    manager->remember(beginning_.past);
    for (const Interrupted& interrupted : beginning_.interrupted) manager->resume(interrupted);
    return manager;
  }

  // The journal's content outlives a crash, and so does a pause; the rest must be observed again.
  void begin_manager() {
    const bool was_paused = manager_ && manager_->governor().is_paused();
    if (manager_) check_replay();
    beginning_ = {};
    if (manager_) beginning_.known_robot = manager_->knowledge().known_robot();
    for (std::size_t s = 0; manager_ && s < rules_.strategies.size(); ++s)
      beginning_.beliefs.push_back(manager_->knowledge().beliefs[StrategyId(s)]);
    beginning_.start = robot_.now();
    stepped_ = kLongAgo;
    beginning_.past = journal::still_counting(memory_.past(), robot_.now(), rules_);
    beginning_.interrupted = memory_.interrupted();
    manager_ = make_manager();
    recorded_.clear();
    if (was_paused)
      orders_.insert(orders_.begin(), {robot_.now(), Order{0, "before the crash", "", Pause{}}});
    invariants_.begin(*manager_);
  }

  // It ends when it has just decided, and nothing of that was asked for yet.
  bool dies_deciding(std::span<const Command> commands) {
    if (!is_to_die_deciding_ || commands.empty()) return false;
    is_to_die_deciding_ = false;
    say("the manager crashes before it asks", "!");
    begin_manager();
    robot_.rediscover(memory_.past());
    return true;
  }

  void befall(const Mishap& mishap) {
    say(describe(mishap), "!");
    // A mishap under way lasts on while the manager's clock jumps.
    if (mishap.kind == Kind::kJump) {
      over_ += mishap.lasts;
    } else {
      over_ = std::max(over_, robot_.now() + mishap.lasts);
    }
    const ComponentId component(mishap.part);
    switch (mishap.kind) {
      case Kind::kCrash:
        is_to_die_deciding_ = mishap.part % 2 == 1;
        if (is_to_die_deciding_) return;
        begin_manager();
        return robot_.rediscover(memory_.past());
      case Kind::kStall:
        stalled_until_ = robot_.now() + mishap.lasts;
        return;
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

  // Messages that come while it stands still are there when it goes on. Then it knows, as from the
  // runtime, that it, or the clock, was late.
  void watch(Time until, std::vector<Observation>& observations) {
    const Time due = std::max(stepped_, manager_->next_deadline());
    robot_.observe(until, observations);
    while (robot_.now() < stalled_until_) robot_.observe(stalled_until_, observations);
    const Time now = robot_.now();
    if (auto late = Runtime::lateness(due, now); late && stepped_ != kLongAgo)
      observations.insert(observations.begin(), std::move(*late));
    stepped_ = now;
  }

  void step(Time until) {
    std::vector<Observation> observations;
    watch(until, observations);
    while (!due_.empty() && due_.begin()->first <= robot_.now()) {
      std::visit([&](const auto& what) { order(what); }, due_.begin()->second);
      due_.erase(due_.begin());
    }
    std::move(orders_.begin(), orders_.end(), std::back_inserter(observations));
    orders_.clear();
    note_health();
    const Time now = robot_.now();
    const std::vector<Command> commands = manager_->step(now, observations);
    ++outcome_.steps;
    std::vector<std::string> words = words_of(*manager_, commands, rules_);
    for (const std::string& line : words) say(line, " ");
    if (!words.empty()) said_ = now;
    for (const Event& event : manager_->events()) {
      const auto* accepted = std::get_if<OrderAccepted>(&event.what);
      const auto* refused = accepted ? std::get_if<Refuse>(&accepted->order.what) : nullptr;
      if (refused != nullptr) refused_.insert(rules_[refused->strategy].rule);
      if (const auto* held = std::get_if<FailureHeldBack>(&event.what)) waits_[held->rule] = *held;
    }
    invariants_.check(*manager_, now, commands, truth());
    memory_.note(observations, manager_->events(), commands);
    recorded_.push_back({now, std::move(observations), std::move(words)});
    if (dies_deciding(commands)) return;
    for (const Command& command : commands) robot_.execute(command);
    end_with_launches();
    answer_questions();
  }

  // As the live session does.
  void end_with_launches() {
    if (manager_->governor().is_paused()) return;
    for (std::size_t part = 0; part < scenario_.parts.size(); ++part) {
      const int pid = manager_->knowledge().departures.to_end(ComponentId(part));
      if (pid != 0) robot_.end_stand_in(part, pid);
    }
  }

  void note_health() {
    was_there_.resize(scenario_.parts.size());
    well_since_.resize(scenario_.parts.size(), kNever);
    for (std::size_t i = 0; i < well_since_.size(); ++i) {
      was_there_[i] = was_there_[i] || robot_.process(i) != ProcessState::kGone;
      if (!robot_.works(i)) {
        well_since_[i] = kNever;
      } else if (well_since_[i] == kNever) {
        well_since_[i] = robot_.now();
      }
    }
  }

  Invariants::Truth truth() const {
    Invariants::Truth truth;
    truth.well_since = well_since_;
    const Duration known = 2 * kPeriod + scenario_.noise.lateness;
    for (std::size_t i = 0; i < scenario_.parts.size(); ++i) {
      truth.processes.push_back(robot_.process(i));
      truth.is_faulty.push_back(robot_.is_faulty(i));
      truth.is_launched.push_back(robot_.was_launched_within(i, known));
    }
    for (std::size_t i = 0; i < scenario_.parts.size(); ++i)
      truth.is_leaving.push_back(robot_.has_left_for(i, known));
    truth.was_there = was_there_;
    truth.is_moving = scenario_.has_interlock && robot_.has_moved_for(known);
    return truth;
  }

  // A failure may be there for good: what explains it waits for a person, and so does it.
  bool is_settled() const {
    if (!manager_->governor().silences().empty()) return false;
    const auto is_in = [&](RulePhase phase) {
      for (std::size_t r = 0; r < rules_.rules.size(); ++r) {
        if (manager_->knowledge().states[RuleId(r)].phase == phase) return true;
      }
      return false;
    };
    if (is_in(RulePhase::kAttempting)) return false;
    return !is_in(RulePhase::kFailing) || robot_.now() - said_ >= kGivenUp;
  }

  void check_liveness() {
    const Governor& governor = manager_->governor();
    if (governor.is_paused() || governor.storm()) return;
    for (std::size_t i = 0; i < scenario_.parts.size(); ++i) {
      if (!robot_.works(i) && !is_excused(i))
        return fail("c" + std::to_string(i) + " is not repaired, and no report says why");
    }
  }

  // Whether culprit reported to a person, at the end, why this part or one that it needs does not
  // work.
  bool is_excused(std::size_t part) const {
    std::vector<std::size_t> needed = all_needs(scenario_, part);
    needed.push_back(part);
    const auto is_about = [&](RuleId rule) {
      return std::find(needed.begin(), needed.end(), rules_[rule].components.front().index) !=
             needed.end();
    };
    // No other strategy begins while a person is asked for approval of one.
    for (const StrategyId asked : manager_->governor().asked()) {
      if (is_about(rules_[asked].rule) || is_joined(ComponentId(part), rules_[asked])) return true;
    }
    const std::set<RuleId> left = left_to_person();
    if (std::any_of(left.begin(), left.end(), is_about)) return true;
    if (std::any_of(needed.begin(), needed.end(),
                    [&](std::size_t p) { return is_never_seen(p) || is_left_down(p); }))
      return true;
    for (std::size_t r = 0; r < rules_.rules.size(); ++r) {
      const RuleId id(r);
      if (manager_->knowledge().states[id].phase == RulePhase::kExhausted && is_about(id))
        return true;
    }
    const auto& silences = manager_->governor().silences();
    return std::any_of(silences.begin(), silences.end(), [&](const auto& silence) {
      const auto* rule = std::get_if<RuleId>(&silence.what);
      if (rule != nullptr) return is_about(*rule);
      return std::find(needed.begin(), needed.end(), std::get<ComponentId>(silence.what).index) !=
             needed.end();
    });
  }

  // Failures that are left to a person, and those whose last word was that they wait for such a one:
  // it may be their cause, or they would be in its way. A part may only seem to need another:
  // topics that all share join what does not.
  std::set<RuleId> left_to_person() const {
    const RuleStates& states = manager_->knowledge().states;
    std::set<RuleId> left = refused_;
    for (const StrategyId asked : manager_->governor().asked()) left.insert(rules_[asked].rule);
    for (const RuleId id : states.exhausted()) {
      if (states.awaits_person(id)) left.insert(id);
    }
    const auto waits = [&](const FailureHeldBack& word) {
      return states[word.rule].phase == RulePhase::kFailing &&
             std::any_of(word.candidates.begin(), word.candidates.end(), [&](const Candidate& c) {
               return c.failure && left.contains(*c.failure);
             });
    };
    for (std::size_t before = 0; before != left.size();) {
      before = left.size();
      for (const auto& [rule, word] : waits_) {
        if (waits(word)) left.insert(rule);
      }
    }
    return left;
  }

  // It was ended by a person, and no culprit saw it since: it stays down, and that was reported.
  bool is_left_down(std::size_t part) const {
    const ComponentId component(part);
    return manager_->knowledge().departures.stays_down(component) &&
           manager_->knowledge().components[component].node_seen == kLongAgo;
  }

  // It never published, and that was reported.
  bool is_never_seen(std::size_t part) const {
    const std::string topic = "/c" + std::to_string(part);
    for (std::size_t t = 0; t < rules_.topics.size(); ++t) {
      if (rules_.topics[t].name == topic) return !manager_->knowledge().discovered.has(TopicId(t));
    }
    return false;
  }

  // By what the manager sees: topics that all parts share join those that do not need each other.
  bool is_joined(ComponentId part, const Strategy& strategy) const {
    const auto depends = [&](ComponentId consumer, ComponentId producer) {
      const auto& upstream = manager_->knowledge().graph.upstream(consumer);
      return std::find(upstream.begin(), upstream.end(), producer) != upstream.end();
    };
    return std::any_of(strategy.components.begin(), strategy.components.end(),
                       [&](ComponentId c) { return depends(part, c) || depends(c, part); });
  }

  void check_replay() {
    const auto again = make_manager();
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
  Memory memory_;
  Invariants invariants_;
  std::unique_ptr<Manager> manager_;
  Beginning beginning_;
  bool is_to_die_deciding_ = false;
  Time stalled_until_ = kLongAgo;
  Time stepped_ = kLongAgo;
  std::vector<bool> was_there_;   // by part: it was started at least once
  std::vector<Time> well_since_;  // by part; kNever: it does not work
  std::vector<Step> recorded_;
  std::vector<Observation> orders_;
  std::multimap<Time, std::variant<Resume, Approve, Refuse>> due_;
  Time over_ = kQuiet;  // what happens by itself
  Time calm_since_{};
  Time said_{};                              // anything, the manager, last
  std::set<RuleId> refused_;                 // a person refused a strategy of theirs
  std::map<RuleId, FailureHeldBack> waits_;  // the last word on why each waits
  RunOutcome outcome_;
};

}  // namespace

RunOutcome run(const Scenario& scenario) { return Run(scenario).go(); }

}  // namespace culprit::torture
