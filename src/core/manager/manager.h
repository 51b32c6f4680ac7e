// The managing system: monitor, analyze, plan, execute over shared knowledge (paper, "Managing
// system").
//
// A pure state machine. No clock, no thread, no I/O, nothing random: the same observations give the
// same commands and the same events. Live runs, simulations, replays and tests drive the same step.
//
//     Manager manager(rules, std::make_unique<BayesPlanner>(), {.start = now});
//     for (const Command& command : manager.step(now, observations)) carry_out(command);
//     for (const Event& event : manager.events()) print(describe(event, rules));
//     // step again when something was observed (replies, too), or at manager.next_deadline()
//
// Runtime (runtime.h) does that for a Robot. examples/t01 is this in full.
//
// Not thread-safe; one owner calls it.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "analyze/analyzer.h"
#include "analyze/trouble_watch.h"
#include "execute/governor.h"
#include "execute/strategy_executor.h"
#include "incidents/incidents.h"
#include "knowledge/knowledge.h"
#include "manager/held_back_reports.h"
#include "manager/managing_system.h"
#include "monitor/monitor.h"
#include "plan/planner.h"

namespace culprit {

class Manager : public ManagingSystem {
 public:
  // Discovery takes this long in the worst case: participants announce themselves every 3 s.
  static constexpr Duration kDiscovery = std::chrono::seconds(5);

  struct Options {
    Autonomy autonomy = Autonomy::kAct;
    Time start{};                     // when watching begins
    Duration discovery = kDiscovery;  // grace period; nothing is reported absent before it ends
    // Discount factor per outcome (1 = never forget).
    double forgetting = 1;
    Governor::Options governor{};
    IncidentIds incidents{};
  };

  // `rules` must outlive the manager and keep its address.
  Manager(const RuleSet& rules, std::unique_ptr<const Planner> planner, Options options);
  ~Manager() override;

  // Never throws, never blocks; allocates nothing while nothing is wrong.
  std::vector<Command> step(Time now, std::span<const Observation> observations) override;
  Time next_deadline() const override;
  std::span<const Event> events() const override { return knowledge_.events; }
  const Knowledge& knowledge() const { return knowledge_; }
  const Governor& governor() const { return governor_; }
  Autonomy autonomy() const { return autonomy_; }
  // Whether culprit would receive the robot's messages. If not, it judges nothing.
  bool hears() const { return hears_; }
  // When the robot has had its time to show itself (Options::discovery).
  Time discovered() const { return discovered_; }

  // The failures that wait for a decision now, ascending.
  std::vector<RuleId> plannable() const { return analyzer_.plannable(now_); }

  // Why nothing at all is begun now, whatever was planned; nothing if it is.
  std::optional<std::string> held_back() const;

  // The open incidents, as after the last step.
  const Incidents& incidents() const { return incidents_; }
  Incidents::Course course_of(const Incident& incident) const;

  // For what was learned in an earlier run.
  void set_belief(StrategyId id, Belief belief) { knowledge_.beliefs.set(id, belief); }
  void set_belief(StrategyId id, Belief belief, Belief prior) {
    knowledge_.beliefs.set(id, belief, prior);
  }
  void set_coupling(RuleId cause, RuleId effect, Coupling coupling) {
    knowledge_.couplings.set(cause, effect, coupling);
  }
  void set_latency(RuleId rule, const Latencies::Learned& learned) {
    knowledge_.latencies.set(rule, learned);
  }
  void add_transients(RuleId rule, const Transients::Seen& seen) {
    knowledge_.transients.add(rule, seen);
  }
  void set_coincidence(RuleId a, RuleId b, int count) { knowledge_.coincidences.set(a, b, count); }
  // Restores the state that earlier processes left: budgets, back-offs, silences, and the last
  // attempts.
  // Before the first step, and before resume().
  void remember(const History& past);
  // Components and topics that earlier runs saw on this robot count as seen.
  void remember(const KnownRobot& known) { monitor_.remember(known); }
  // A strategy that an earlier process left in the middle is finished, once the robot had the time
  // of discovery to show itself. Before the first step; one for each rule at most.
  void resume(Interrupted interrupted);

 private:
  void check(std::span<const Command> commands) const;
  void take_in(Time now, std::span<const Observation> observations);
  void answered(const Reply& reply, Time now);
  void oversleep(Duration by);
  void restart(Time since, Time now);
  void react(std::vector<Command>& commands);
  void obey(const Order& order, Time now);
  void refresh_conditions(StrategyId strategy, Time now);
  void abandon_what_stays_down(Time now);
  void abandon_all(const std::string& reason, Time now);
  void make_way_for(StrategyId strategy, Time now);
  void plan(Time now, std::vector<Command>& commands);
  bool may_give_back() const;
  void give_back(Time now);
  void ask(const Decision& decision, Time now, std::vector<Command>& commands);
  void begin_last_resorts(Time now);
  bool begin_last_resort(StrategyId strategy, Time now);  // false: it is held back
  void go_before_others(StrategyId last_resort, Time now);
  bool is_beside_last_resort(StrategyId strategy) const;
  bool is_help_possible(RuleId rule, Time limit, Time now) const;
  std::vector<Decision> allowed_plan(const std::vector<RuleId>& failures, Time now);
  // Those parts of a last resort that have an obstacle are left out.
  void begin(StrategyId strategy, Time now, std::vector<std::string> obstacles = {});
  void carry_out(const Decision& decision, Time now);
  void follow_incidents();
  Time next_planning(Time now) const;

  Knowledge knowledge_;
  Monitor monitor_;
  Analyzer analyzer_;
  TroubleWatch troubles_;
  std::unique_ptr<const Planner> planner_;
  execute::StrategyExecutor executor_;
  Governor governor_;
  Incidents incidents_;
  Autonomy autonomy_;
  Time discovered_;  // until then nothing is called absent
  Time now_;
  bool hears_ = true;
  Time deaf_since_ = kLongAgo;
  bool is_incident_due_ = false;  // something that incidents are made of may have changed
  bool news_ = false;             // something a plan depends on changed since the last plan
  Time next_plan_ = kNever;       // while failures are held back
  HeldBackReports held_back_;
};

}  // namespace culprit
