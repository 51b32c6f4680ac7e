// A case of the public benchmark: a robot that nobody repairs, as others see it, and its truth
// (docs/study-rca.md, "Cases for other methods").
//
// A case is made from a random scenario. Its components get an order of their own, since those of
// the generator go from drivers to outputs. The faults begin later, so that the robot is well for a
// while. The manager has a planner that chooses nothing; other planners advise beside it. Only their
// questions reach the robot, whether a component answers, which change nothing. The case ends 5 s
// after the last failure began.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "manager/runtime.h"
#include "plan/bayes/objective.h"
#include "rca_study/rca_scenario.h"

namespace culprit::study::rca {

struct CaseCause {
  InjectedFault fault;
  std::string kind;             // of the fault, as others see it: "silent"
  std::vector<Repair> repairs;  // that end it with a probability of at least 0.5
};

// A component without a fault that was ill because of faults. A fault is a cause of it if it alone
// would make the component ill, or if the component would be well without it.
struct CaseEffect {
  std::size_t component = 0;
  std::vector<std::size_t> causes;  // components, ascending
  double since_s = 0;
};

struct CaseTruth {
  std::vector<CaseCause> causes;    // by component
  std::vector<CaseEffect> effects;  // likewise
  double end_s = 0;                 // of the case
};

// The effects of the scenario's faults without a repair; empty if the effects of a fault are hidden:
// its own component or each component that is ill because of it is unwatched.
std::optional<CaseTruth> truth_of(const RcaScenario& scenario);

enum class CaseEventKind : std::uint8_t {
  kExited,     // its process
  kAnswered,   // the component, a question of an adviser
  kUnanswered  // it did not, within 0.5 s
};
std::string_view to_string(CaseEventKind kind);  // "exited", "answered", "unanswered"

struct CaseEvent {
  double at_s = 0;
  std::size_t component = 0;
  CaseEventKind kind = CaseEventKind::kExited;
};

// Notes exits of processes, as the operating system reports them, and the answers to questions.
class CaseEvents {
 public:
  // `events` must outlive it.
  explicit CaseEvents(std::vector<CaseEvent>& events) : events_(events) {}
  void record(const Runtime::Step& step);

 private:
  std::vector<CaseEvent>& events_;
  std::map<CommandId, std::size_t> asked_;  // the component
};

struct Proposal {
  std::size_t component = 0;
  Repair repair = Repair::kRestart;
  double at_s = 0;
};

// A planner's answer to a case, without acting.
struct Advice {
  // Components by the probability of a cause of their own, then by what they explain of others, if
  // the planner has these; else those that it would repair, in its order. As of the last 2 s.
  std::vector<std::size_t> ranked;
  std::vector<std::size_t> causes;  // more likely than not, or those that it would repair
  // The first that it would choose for each component; at the end, also one for each of its causes
  // that still waits for others.
  std::vector<Proposal> repairs;
};

struct RcaCase {
  RcaScenario scenario;
  CaseTruth truth;
  std::vector<std::size_t> watched;         // components with a detector
  std::vector<double> times_s;              // of the readings
  std::vector<std::vector<bool>> readings;  // by time, by place in `watched`: reported ill
  std::vector<CaseEvent> events;
  std::map<std::string, Advice> advice;  // by planner
  std::string rules;                     // that the planners have, as text
};

// The scenario as a case; nothing if it has no truth that counts. The same scenario gives the same
// case.
// @pre the advisers exist (campaign.h), and are not "optimum"
std::optional<RcaCase> case_of(RcaScenario scenario, std::span<const std::string> advisers,
                               Objective objective = Objective::kBalanced);

}  // namespace culprit::study::rca
