// The manager's decisions and actions with their reasons, for people, for the journal, for
// explanations.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "knowledge/blindness.h"
#include "knowledge/coming_up.h"
#include "knowledge/incident.h"
#include "knowledge/stays_down.h"
#include "knowledge/why_unknown.h"
#include "language/rule_set.h"
#include "robot/observation.h"

namespace culprit {

// Why a strategy was not chosen: the paper's conditions (Section "Planning"), and what else can be
// in the way.
enum class Condition : std::uint8_t {
  kTried,       // 1: it was tried already
  kInvalid,     // 2: it makes no sense in the present state of the system
  kAdapting,    // 3: a component of it is being adapted
  kAffected,    // 4: a component of it is affected by a strategy chosen just now
  kDependency,  // 5: a component of it depends on a component that may be the cause
  kOneEach,     // another strategy was chosen for the same failure
  // Only from the bayes planner:
  kDownstream,  // a component of it depends on one that is being adapted
  kSuspect,     // a component of it depends on one that may still prove to be the cause
  kSettling,    // the failure is expected to clear by itself, or with one that was just resolved
  kInTheWay,    // it would delay the repair of another failure
  // Of both planners:
  kWithheld,  // the governor does not allow it now
  // Its component, or one that may be the cause (bayes), is on an unreachable computer, or cannot be
  // judged now for another reason (Candidate::remark).
  kUnheard
};

struct Candidate {
  StrategyId strategy;
  double cost = 0;                    // paper, Eq. 1; bayes: expected (plan/bayes/value.h)
  std::optional<Condition> excluded;  // empty: chosen
  ComponentId component;              // that the condition is about
  std::optional<RuleId> failure;      // kDependency: what `component` may be the cause of;
                                      // also kSuspect, kSettling, kInTheWay: the other failure
  std::string remark;                 // kInvalid, kWithheld, kUnheard, kDependency or kSuspect
                                      // without a failure: why
  // Of a planner that weighs them (bayes) and only if nothing excludes it beforehand.
  double resolves = 0;  // the probability that it resolves the failure
  double value = 0;     // what that is worth, before its cost
  // kDependency, kSuspect, kSettling: it waits no longer than this after the decision, if that is known.
  std::optional<Duration> within{};

  bool operator==(const Candidate&) const = default;
};

enum class EvidenceSource : std::uint8_t {
  kKernel,    // the operating system says so
  kMeasured,  // culprit received it, or did not
  kAnswer,    // a component answered culprit's own question, or did not
  kAlarm,     // a rule fires
  kGraph,     // the graph or the lifecycle of nodes
  kLearned,   // earlier failures
  kModel      // how failures usually come about
};
// "kernel", "measured", "answer", "alarm", "graph", "learned", "model".
std::string_view to_string(EvidenceSource source);

// A piece of evidence for a suspect, or against it (diagnose/evidence.h).
struct Evidence {
  EvidenceSource source = EvidenceSource::kModel;
  std::string text;             // "camera exited"
  std::optional<Duration> age;  // since when, if that is known; kAnswer: when that was
  double log_odds = 0;          // its weight: natural logarithm; below 0 it speaks against it
  std::string
      without{};  // the component that would be held responsible without it; empty: the same

  bool operator==(const Evidence&) const = default;
};
// "camera exited, for 1.20 s (kernel, +2.9)", "camera answered, 0.20 s before (answer)"
std::string describe(const Evidence& evidence);

// A component that may be responsible for a failure.
struct Suspect {
  ComponentId component;
  RuleId failure;                    // that points at it: the failure itself, or one upstream
  double probability = 0;            // that it is
  std::vector<Evidence> evidence{};  // the heaviest first; the likeliest suspect has all answers
};

// A failure was detected.
struct FailureDetected {
  RuleId rule;
  // The trigger's inputs do not show it yet: this component, the only publisher of them, is known
  // dead. `how` it exited: "killed by signal 9".
  std::optional<ComponentId> known_dead{};
  std::string how{};
};

// A failure cleared.
struct FailureResolved {
  enum class How : std::uint8_t {
    kByStrategy,      // the strategy under way resolved it
    kWithoutStrategy  // it cleared without one of its own: another repair, or by itself
  };
  RuleId rule;
  How how = How::kWithoutStrategy;
  std::optional<StrategyId> strategy;
  Duration reaction{};  // since it was detected
};

// The rule's inputs are not received any more, so it is unknown whether the failure is still there.
struct FailureLost {
  RuleId rule;
};

struct StrategyChosen {
  StrategyId strategy;
  std::vector<Candidate> candidates;  // all of the same failure, this one included, by cost
  std::vector<RuleId> explains;     // failures downstream that are expected to clear with this one
  bool dry_run = false;             // it is only said, not done
  std::vector<Suspect> suspects{};  // likeliest first; of a planner that weighs them
  std::vector<ComponentId> also_ended{};  // components whose processes end with it, besides its own
};

// A failure is there, and nothing is done about it now.
struct FailureHeldBack {
  RuleId rule;
  std::vector<Candidate> candidates;
  std::vector<Suspect> suspects{};
};

struct AdaptationDone {
  StrategyId strategy;
  std::size_t adaptation = 0;  // index in Strategy::adaptations
  std::string remark;          // empty, or what was odd ("reads back false")
};

struct AdaptationFailed {
  StrategyId strategy;
  std::size_t adaptation = 0;
  std::string reason;
};

struct StrategyFailed {
  StrategyId strategy;
  std::string reason;
};

// A strategy that an earlier process of culprit did not live to end is being finished.
struct StrategyResumed {
  StrategyId strategy;
};

// Something that a failed strategy had changed is back as it was, or could not be brought back.
struct Undone {
  StrategyId strategy;
  std::string what;
  bool succeeded = true;
};

// All strategies were tried; they are tried anew from `retry_at` on.
struct RoundSpent {
  RuleId rule;
  Time retry_at;
};

// No other strategy of the rule can begin or help in time: its last resorts are due.
struct LastResortReached {
  RuleId rule;
};

// A last resort took effect. Its changes stay as long as the failure is there.
struct LastResortDone {
  StrategyId strategy;
};

// All strategies were tried. A person must look.
struct RuleExhausted {
  RuleId rule;
};

struct ComponentLost {
  ComponentId component;
  std::string remark;
};
struct ComponentFound {
  ComponentId component;
  int pid = 0;
};

// Something that the rules name was not seen in the time that a robot has to show itself. Unknown
// is what rules read of it, until it is seen.
using Nameable = std::variant<ComponentId, TopicId, SignalId, ParameterId, DiagnosticId>;
struct NeverSeen {
  Nameable what;
  std::string near;  // a name of the robot that may be meant; empty: none is near
};

// The trigger of the rule has had no value for a while, so it is unknown whether its failure is
// present (blindness.h). Reported once, until the rule can see again.
struct RuleBlind {
  RuleId rule;
  Blind blind{};
};
// Its trigger has had a value again, for a while.
struct RuleSees {
  RuleId rule;
  Duration blind_for{};
};

// Another state of its lifecycle is the intended one now (ComponentState::intended_lifecycle). Not
// reported to people: it is for the next process of culprit.
struct LifecycleIntended {
  ComponentId component;
  Lifecycle state = Lifecycle::kUnknown;
  // A strategy has deactivated it, and gives it back with its next try (Brought).
  bool is_owed = false;
};

// A process of it came up otherwise than the last one (ComponentState::coming_up). Not reported
// either.
struct CameUp {
  ComponentId component;
  ComingUp how;
};

// Something else sets the mode back that strategies set (rivals.h). It is left alone from now on.
struct RivalSeen {
  ComponentId component;
};

struct Trouble {
  std::string text;
};

// A value that rules read is unknown although samples come: it is not a number, or more samples come
// than its window holds. Reported once; again when it was well for Monitor::kTellAgain meanwhile.
struct ValueUnknown {
  InputId input;
  WhyUnknown why = WhyUnknown::kNotANumber;  // or kOverflow
};

// The answer to a person's order.
struct OrderAccepted {
  Order order;
  std::vector<StrategyId>
      holds_back{};  // last resorts that are not begun either, as long as it holds
};
struct OrderRefused {
  Order order;
  std::string reason;
};

// Why the governor lets nothing, or not this, be done now (docs/governor.md).
enum class Restraint : std::uint8_t {
  kPaused,              // by a person
  kQuietPeriod,         // after start-up, or after a launch
  kStorm,               // too much is ill at once
  kGraphInDoubt,        // nodes vanished whose processes are there: it may be our own network
  kInterlock,           // INTERLOCK is not true
  kOverallIntensity,    // too many strategies lately
  kSilenced,            // by a person
  kRefused,             // by a person
  kComponentIntensity,  // too many strategies lately at this component
  kClassIntensity,      // too many strategies of this kind lately
  kBackoff,             // it was restarted a short while ago
  kIdentity,            // it is uncertain which process it would hit
  kEvidence,            // the process that it would end runs and publishes, or may hang
  kNeverSeen,           // it would start what was never seen
  kLeaving,             // what was started together is being ended together
  kLaunchEnded,         // a person ended it, or may have, or has just started it again
  kContainer,           // its container is being replaced, and then loads it
  kRestarts,            // it was restarted too often: a person must look
  kImpossible           // a last resort that cannot be carried out in the robot's present state
};

// A strategy was chosen and is not begun. Reported again only when the reason is another one.
struct ActionHeldBack {
  StrategyId strategy;
  Restraint restraint = Restraint::kPaused;
  std::string reason{};
  Time until = kNever;  // when the reason may end; kNever: unknown
  // As StrategyChosen's, if everything has to wait; empty if only this strategy has to.
  std::vector<Candidate> candidates{};
  std::vector<Suspect> suspects{};
};

// The strategy waits for a person to approve or refuse it. The question lapses when the failure is
// gone, or another strategy has become the better one.
struct ApprovalAsked {
  StrategyId strategy;
  std::vector<Candidate> candidates;  // as StrategyChosen's
  std::vector<Suspect> suspects{};
};
struct ApprovalLapsed {
  StrategyId strategy;
};

// A strategy under way was left where it was, without a verdict.
struct StrategyAbandoned {
  StrategyId strategy;
  std::string reason;
};

// A strategy that a person ordered while its failure was not there took effect.
struct OrderCarriedOut {
  StrategyId strategy;
};

// The verdict on a strategy is in, and pending until `due` (outcomes.h). Not reported to people.
struct OutcomePending {
  StrategyId strategy;
  bool has_helped = false;
  Time due;
};

// The outcome of a strategy is learned, or dropped (outcomes.h). Not reported to people.
struct OutcomeCounted {
  enum class As : std::uint8_t {
    kSuccess,
    kFailure,
    kNothing  // something else can have had the same effect, or it cannot be seen
  };
  StrategyId strategy;
  As as = As::kNothing;
};

// The failure is flapping: it counts as one until it stayed away for long enough to be proven gone.
struct FailureFlaps {
  RuleId rule;
  int times = 0;  // that it came
};

// Its time is over.
struct SilenceEnded {
  Silenceable what;
};

// The governor stops all action, or lets it go on. A person should look.
struct StormBegan {
  Restraint restraint = Restraint::kStorm;  // or kGraphInDoubt
  std::string reason;
};
struct StormEnded {};

// culprit judges nothing from now on, since it cannot know which messages it misses.
struct JudgementSuspended {
  std::string reason;
};
// All ages, and all times that something has to last, begin anew.
struct JudgementResumed {};
// The same, after culprit stood still for so long.
struct SleepNoticed {
  Duration time{};
};

// Another computer where components ran became unreachable: it is down, or cut off. It is one cause,
// however many rules fail because of it.
struct HostSilent {
  std::string host;
  std::vector<ComponentId> components;  // that ran there
  bool is_last = false;  // no other computer is reachable either, and there are several
};
struct HostBack {
  std::string host;
};

// Beliefs now begin from priors that the robots of a fleet learned. If `source` is empty, no fleet
// has any, and they begin from the rule file's priors again.
struct PriorsAdopted {
  std::vector<PriorsTold::Prior> priors;
  std::string source;
};

// Incidents (incidents/incidents.h). Without a sentence: the events above tell people what happened.
struct IncidentOpened {
  Incident incident;
};
// Something about it is different now, but for times that pass.
struct IncidentChanged {
  Incident incident;
};
struct IncidentClosed {
  std::string id;
  RuleId root;
  IncidentEnd how = IncidentEnd::kResolved;
  std::string into{};  // kMerged: the id of the other one
};

// One of these happened. To copy and to destroy a variant of so many is compiled once (event.cpp), not into every file that
// touches an event.
class EventWhat
    : public std::variant<
          FailureDetected, FailureResolved, FailureLost, StrategyChosen, FailureHeldBack,
          AdaptationDone, AdaptationFailed, StrategyFailed, StrategyResumed, Undone, RoundSpent,
          RuleExhausted, ComponentLost, ComponentFound, RivalSeen, Trouble, OrderAccepted,
          OrderRefused, ActionHeldBack, ApprovalAsked, ApprovalLapsed, StrategyAbandoned,
          OrderCarriedOut, SilenceEnded, StormBegan, StormEnded, LastResortReached,
          LifecycleIntended, CameUp, OutcomePending, OutcomeCounted, FailureFlaps,
          JudgementSuspended, JudgementResumed, SleepNoticed, NeverSeen, PriorsAdopted, HostSilent,
          HostBack, ValueUnknown, LastResortDone, RuleBlind, RuleSees, StaysDown, IncidentOpened,
          IncidentChanged, IncidentClosed> {
 public:
  using Variant = variant;
  using variant::variant;
  EventWhat();
  EventWhat(const EventWhat& other);
  EventWhat(EventWhat&& other) noexcept;
  EventWhat& operator=(const EventWhat& other);
  EventWhat& operator=(EventWhat&& other) noexcept;
  ~EventWhat();
};

struct Event {
  Time at;
  EventWhat what;
};

}  // namespace culprit
