// Strategies -> commands (paper, "Execution").
//
// A strategy's adaptations are carried out in the order they are written, each to its proof
// (goal.h), before the next begins. If one cannot be carried out, or the verdict is that the
// strategy failed, its changes are undone in reverse order where they can be, and where nothing else has
// changed the same since. A component that was taken down while another one was adapted is not brought up
// again where that one is down. A step that activates what an earlier one deactivates gives back what that
// one took: what was not active before stays so. From its choice to
// the end of its undoing a strategy has its components to itself, but for last resorts: these go
// beside it and are not undone, and no other undoing touches their changes. If a process that it changed
// exits or is stopped before the verdict, it fails at once: the process is to be replaced.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "execute/component_notes.h"
#include "execute/pursuit.h"
#include "execute/resumption.h"
#include "knowledge/attempts.h"
#include "knowledge/knowledge.h"

namespace culprit::execute {

class StrategyExecutor {
 public:
  static constexpr Duration kUnsure = std::chrono::seconds(10);

  // What it writes; all else it only reads.
  struct Writes {
    Attempts attempts;
    ComponentStates& components;  // what it brought about, and what it asked
    SignalStore& signals;         // rules whose attempt came to another stage are to be looked at
    PendingOutcomes& outcomes;    // those that a change voids
    Rivals& rivals;
    EventLog& events;
  };

  // `knowledge` must outlive the executor.
  StrategyExecutor(const Knowledge& knowledge, Writes writes);
  ~StrategyExecutor();

  // The rule's attempt begins. @pre none of the rule is under way (a last resort:
  // none of its last resorts); none has its components, or it is a last resort
  // Of a last resort without steps no part keeps the others from being carried out: not one that fails, and not
  // those that have an obstacle (by place; empty: none), which are left out. Then it failed for that.
  void begin(StrategyId strategy, Time now, std::vector<std::string> obstacles = {});

  // Activates what the strategy, or one like it, has left inactive: an undo that is not over yet.
  // @pre as begin()'s; the rule is quiet, and the strategy adapts the component
  void give_back(StrategyId strategy, ComponentId component, Time now);

  // Goes on from `from` on with an attempt of an earlier process; its outcome will prove nothing. Ignored if it
  // had failed and there is nothing to undo.
  // @pre nothing was begun yet
  void resume(Interrupted interrupted, Time now, Time from);

  // Answers until `now` could not be received: every goal under way has its whole time again, and
  // looks before it acts. For kUnsure no question counts as unanswered.
  void restart(Time now);

  // Asks the component whether it answers, before the strategy is begun. It has `timeout` to do so.
  void ask(ComponentId component, StrategyId strategy, Duration timeout, Time now,
           std::vector<Command>& commands);
  // Open questions prove nothing: culprit could not receive the answers.
  void forget_questions();
  // The component that `reply` proves to answer; before answered().
  std::optional<ComponentId> proven_by(const Reply& reply) const;

  // An answer; it is ignored if the request is no longer open.
  void answered(const Reply& reply, Time now);

  // Takes every attempt as far as it goes, and appends the requests that are due. Touches the rules
  // whose attempt came to another stage.
  void advance(Time now, std::vector<Command>& commands);

  Time next_deadline() const;

 private:
  struct Run {
    RuleId rule;
    StrategyId strategy;
    bool is_undoing = false;
    std::size_t adaptation = 0;
    std::vector<Goal> goals;  // of the adaptation
    std::size_t goal = 0;
    std::optional<Pursuit> pursuit;
    CommandId pending;
    std::string remark;
    std::vector<Undo> undo;
    Time started = kNever;  // the first process that it started
    int starts = 0;         // that its process ended after it had been there
    struct BroughtUp {
      ComponentId component;
      Time at{};
    };
    std::vector<BroughtUp> brought_up{};   // of a group
    std::vector<std::string> obstacles{};  // of the parts of a last resort
    std::string missed{};                  // why a part of it was not carried out
    // For a resumed run, until the robot had the time to show itself.
    std::optional<Interrupted> interrupted;
    Time from = kLongAgo;
  };

  struct Question {
    CommandId command;
    ComponentId component;
  };

  Run& add_run(StrategyId strategy);
  void advance(Run& run, Time now, std::vector<Command>& commands);
  bool take_up(Run& run, Time now);
  Purpose purpose_of(const Run& run) const;
  bool next_goal(Run& run, Time now);
  Expected<std::vector<Goal>> goals_of(const Run& run, Time now);
  bool leaves_out(Run& run);
  bool goes_past(Run& run, const std::string& obstacle, const std::string& reason, Time now);
  bool has_nothing_to_do(const Run& run, Time now);
  bool has_taken(const Run& run, ComponentId component) const;
  bool start_again(Run& run, Time now);
  void fail_with_lost_process(const Run& run);
  std::optional<ComponentId> deactivated_meanwhile(const Run& run) const;
  bool is_managed_still(const Run& run) const;
  void note_begun_anew(const Run& run, Time now);
  void note_undo(Run& run);
  bool next_undo(Run& run, Time now);
  struct Missing {
    ComponentId component;
    const char* why = "";
  };
  std::optional<Missing> missing_for(const Run& run, const Undo& undo) const;
  bool is_held_by_last_resort(const Undo& undo) const;
  bool is_changed_by_another(const Undo& undo) const;
  void tell_left_out(const Run& run, const std::string& why, Time now);
  void owe(const Undo& undo, Time now);
  void owe_restart(const Run& run, Time now);
  void owe_no_more(ComponentId component, Time now);
  void finish_goal(Run& run, Time now);
  bool replace_hung_member(Run& run) const;
  void finish_undo(Run& run, Time now);
  void undo_at_next_start(StrategyId strategy, const Undo& undo, Time now);
  void take_owed(const Adaptation& adaptation, std::vector<Goal>& goals);
  void forget_owed(ComponentId component, const std::string& parameter);
  void forget_what_others_started(Time now);
  bool is_of_present_process(const Question& question) const;
  void note_answer(const Question& question, Outcome outcome);
  void note_change(Run& run, Time now);
  void note_rival(const Run& run, Time now);
  const Attempt* attempt_of(const Run& run) const;
  void obstruct(const Run& run, std::string obstacle, const std::string& reason, Time now);

  const Knowledge& knowledge_;
  Writes write_;
  ComponentNotes notes_;
  std::vector<Run> runs_;
  // Parameters to be undone in processes that had exited by then; kept until the process is there
  // again, whoever starts it.
  struct Owed {
    StrategyId strategy;  // whose change it was
    Undo undo;
  };
  std::vector<Owed> owed_;
  std::vector<Question> questions_;  // that were not answered yet
  Time unsure_until_ = kLongAgo;
  std::uint64_t last_command_ = 0;
};

}  // namespace culprit::execute
