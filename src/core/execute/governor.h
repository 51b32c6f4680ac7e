// Decides whether the planned strategies may begin now (docs/governor.md).
//
// It chooses nothing and does nothing by itself: it permits, or refuses with a reason. A reason is
// about everything (paused, a storm), or about one strategy; then the next best one may be tried. A
// person's orders go through it, too.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "execute/limits.h"
#include "execute/storm_watch.h"
#include "knowledge/history.h"
#include "knowledge/knowledge.h"
#include "robot/order.h"

namespace culprit {

enum class Autonomy : std::uint8_t {
  kAct,
  kAdvise  // dry run: strategies are chosen and said, and nothing is done
};

// Whether a person has to approve each strategy before it is begun.
enum class Approval : std::uint8_t { kNone, kEach };

class Governor {
 public:
  struct Options {
    Approval approval = Approval::kNone;
    Duration quiet_at_start{};  // nothing is begun for so long
    execute::Limits::Options limits{};
    execute::StormWatch::Options storm{};
    bool needs_evidence = false;  // before a process is ended (evidence.h)
    // A launch that ends so soon after a crash that it may have ended because of that is started again.
    bool revives_in_doubt = false;

    // By default nothing is limited, because a study measures the planner. These are the limits for
    // a robot; docs/governor.md gives the reasons for the numbers.
    static Options recommended();
  };
  struct ActiveSilence {
    Silenceable what;
    Time until = kNever;
    std::string author;
    std::string reason;
  };
  using Held = execute::Limits::Limit;

  // What it writes; all else it only reads.
  struct Writes {
    Knowledge::WithheldList& withheld;
    EventLog& events;
  };

  // `knowledge` must outlive the governor.
  Governor(const Knowledge& knowledge, Writes writes, Options options, Time start);

  // The budgets that earlier processes spent, and the orders that people gave them. Before the
  // first advance().
  void remember(const History& past);

  // ---- orders

  // Why the order cannot be followed; nothing if it can.
  std::optional<std::string> objection(const Order& order, Autonomy autonomy) const;
  // Applies the order. @pre there is no objection to it
  void obey(const Order& order, Time now);

  bool is_paused() const { return is_paused_; }
  const std::optional<execute::StormWatch::Storm>& storm() const { return storm_.storm(); }
  const std::vector<ActiveSilence>& silences() const { return silences_; }
  // The strategy that the order begins at once: one that a person runs, or approves after a program
  // proposed it; empty: none.
  std::optional<StrategyId> begun_by(const Order& order) const;

  // The strategies that wait for approval.
  std::vector<StrategyId> asked() const;

  // ---- plans

  // Before each plan: strategies that were withheld may be allowed by now.
  void begin_planning();
  // Whether the strategy may not be begun although others may. If so, it is marked
  // (Knowledge::withheld), so that a new plan finds the alternatives, and an event reports it.
  bool withholds(StrategyId strategy, Time now);
  // Whether everything has to wait now, the strategy that was chosen too. If so, an event reports
  // it: `chosen` with the reason.
  bool holds_back(ActionHeldBack chosen, Time now);
  // Whether the last resort has to wait: for a person who paused or muted, or because of `obstacle`,
  // which keeps it from being carried out. No limit holds it. If so, an event reports it.
  bool holds_last_resort_back(StrategyId strategy, std::optional<std::string> obstacle, Time now);
  // The last resorts that the order holds back: a pause all, a silence those that it is about.
  std::vector<StrategyId> last_resorts_behind(const Order& order) const;
  // Whether a person has to approve it first, and did not yet. If so, the person is asked.
  bool awaits_approval(const ApprovalAsked& choice, Time now);
  // It is begun.
  void began(StrategyId strategy, Time now);
  // Why everything has to wait now; nothing if it need not.
  std::optional<Held> restraint_on_all(Time now) const;

  // ---- time

  void advance(Time now);
  // The events of the step that is over.
  void note(std::span<const Event> events);
  Time next_deadline() const;

 private:
  struct Told {
    Time failing_since = kNever;
    Restraint restraint = Restraint::kPaused;
  };
  struct Question {
    StrategyId strategy;
    Time failing_since = kNever;
    bool is_approved = false;
    bool is_proposed = false;  // by a program, not by the planner
  };

  std::optional<std::string> objection_to_propose(StrategyId id) const;
  std::optional<std::string> objection_to_run(StrategyId id, Autonomy autonomy) const;
  std::optional<Held> restraint_on(StrategyId strategy, Time now) const;
  std::optional<Held> restraint_on_last_resort(StrategyId strategy, Time now) const;
  std::optional<std::string> objection_to_last_resort(const Strategy& strategy) const;
  std::optional<std::string> objection_by_when(const Strategy& strategy) const;
  std::optional<Held> restraint_by_person(StrategyId strategy) const;
  std::optional<Held> departure(const Strategy& strategy, Time now) const;
  std::optional<Held> doubt_of_storm(RuleId failure) const;
  std::optional<Held> container_to_come(const Strategy& strategy) const;
  bool stays_anything_down() const;
  std::optional<Held> lack_of_evidence(const Strategy& strategy, Time now) const;
  // Holds against a person's order, too.
  std::optional<Held> interlock() const;
  Time comes_up_by(ComponentId component) const;
  void tell(ActionHeldBack what, const Held& held, Time now);
  Question* question_of(StrategyId strategy);
  const Question* question_of(StrategyId strategy) const;
  bool is_open(const Question& question) const;

  const Knowledge& knowledge_;
  Writes write_;
  Options options_;
  Time start_;
  execute::Limits limits_;
  execute::StormWatch storm_;
  bool is_paused_ = false;
  std::vector<ActiveSilence> silences_;
  std::vector<Question> questions_;
  std::vector<StrategyId> withheld_;  // since the plan was begun
  std::vector<Time>
      refused_;             // by strategy: since when the failure was there that it was refused for
  std::vector<Told> told_;  // by strategy: what was said last
};

}  // namespace culprit
