// Which components are asked whether they answer, before something is taken down, or asked to change.
//
// A supplier that hangs is found by periodic questions only after several went unanswered; until then
// its consumer looks like the cause. So before a failure is repaired by taking something down, those
// upstream are asked that gave no sign of life since it began, the nearest first. Asked are only
// components that can answer as far as is known: one that never did, and was asked in vain, is not
// asked again, and is not taken to hang.
//
// Those that a strategy would send requests to are asked as well. One that answers no question lets such requests
// time out, one strategy after another, before its process is replaced.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "diagnose/lost.h"
#include "diagnose/trouble.h"

namespace culprit::diagnose {

// An answer that takes longer than this does not come.
inline constexpr Duration kAnswersWithin = std::chrono::milliseconds(500);
// So long the answer to a question is waited for: until it is known that none came.
inline constexpr Duration kLongestQuestion = std::chrono::milliseconds(600);
// A component is not asked again before; if it answered, not before kLongestQuestion.
inline constexpr Duration kAskedAgain = std::chrono::seconds(2);
// A sign of life counts from so long after the onset on: the component may have hung right after an
// earlier one.
inline constexpr Duration kProvesHealth = std::chrono::milliseconds(100);
// How many questions may be open at once.
inline constexpr std::size_t kMostQuestions = 16;

struct Questions {
  std::vector<ComponentId> asks;  // to be asked now, nearest first
  // The failure waits for its answer: one of those asked, or one that is asked once others have answered.
  std::optional<ComponentId> awaited;
  // Lost messages explain the failure, and their publisher has answered since it began: it works, and
  // nothing is to be taken down for the failure.
  std::optional<Lost> lost;
};

// Asks on behalf of the failures of one planning step: a question of one of them counts for the others.
class Questioner {
 public:
  // `troubles`: by component. Both must outlive it.
  Questioner(const Knowledge& knowledge, std::span<const std::optional<TroubleSeen>> troubles);

  // Before the strategy takes something down for its failure.
  Questions about(const Strategy& strategy);

  // Before requests are sent to these components for the failure: of those that answered ever, and gave no sign of life
  // since the failure began. Asked in vain, one is asked a second time at once.
  Questions to(std::span<const ComponentId> components, RuleId failure);

 private:
  using IsAllowed = bool (*)(const ComponentState&, Time now);
  void ask(std::span<const ComponentId> silent, IsAllowed is_allowed, Questions& questions);
  void ask_publisher(const Lost& lost, RuleId failure, Questions& questions);
  void look();
  bool may_hang(ComponentId component) const;
  // A sign of life counts from then on.
  Time shows_since(RuleId failure) const;
  std::vector<ComponentId> suppliers(const Strategy& strategy) const;

  const Knowledge& knowledge_;
  std::span<const std::optional<TroubleSeen>> troubles_;
  std::size_t open_ = 0;            // questions, those of this step included
  std::vector<ComponentId> asked_;  // in this step
  std::vector<Time> last_signs_;    // by component; empty before look()
  Time oldest_sign_ = kNever;       // of those that may hang
};

// Was the component asked twice in vain, since it answered last?
bool answers_no_question(const ComponentState& state);

// Was the component asked in vain, so that it presumably hangs: it answered before, and gave no sign
// of life since?
bool is_overdue(ComponentId component, const Knowledge& knowledge);
// Is it time to ask such a one again?
bool is_to_be_asked_again(ComponentId component, const Knowledge& knowledge);
// The same for one whose trouble explains a failure: also if only its values have stopped, which it may send on change.
bool is_to_be_asked(ComponentId component, const TroubleSeen& trouble, const Knowledge& knowledge);

}  // namespace culprit::diagnose
