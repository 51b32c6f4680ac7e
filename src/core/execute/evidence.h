// Is it known which process would be ended, and does the evidence allow ending it?
// (docs/governor.md, "Evidence", "Who is hit")
//
// There are three witnesses: the operating system about the process, the graph about the node, and
// the component's own topics. A running process alone proves little, for it may be stuck. But if
// the process runs, its node is there and its topics arrive, it is at work, and the silence of
// something else is no reason to end it.
#pragma once

#include <optional>
#include <string>

#include "knowledge/knowledge.h"

namespace culprit {

// Why a component that the strategy redeploys is not what is broken; nothing if nothing says so.
//
// Only an outage needs agreement: a rule whose trigger reads a value (a quality, a diagnostic, a
// parameter) has seen for itself that something works badly, and names who is to be redeployed for
// it. Nor does a last resort, or `stop`, accuse anybody: it is what is wanted then.
std::optional<std::string> contradiction(const Strategy& strategy, const Knowledge& knowledge,
                                         Time now);

// It is asked whether it is there, answered before, and its answer is overdue.
bool owes_answer(const ComponentState& state, Time now);

// It will be known soon whether a component that the strategy ends, or takes through its lifecycle, hangs: its answer is overdue, or it did not answer since the
// rule's topics fell silent. A component that hangs gets no SIGTERM first, and no other request. After a SIGTERM it can hardly be told whether it hung. Empty: it
// answers, or is never asked. A last resort does not wait.
struct AnswerToCome {
  std::string reason;
  Time until;
};
std::optional<AnswerToCome> answer_to_come(const Strategy& strategy, const Knowledge& knowledge,
                                           Time now);

// Why it would start what was never seen (knowledge/sightings.h); nothing if it does not. Absent is
// not dead, and only people and `run --launch` start what was not there.
std::optional<std::string> launch_of_the_unseen(const Strategy& strategy,
                                                const Knowledge& knowledge);

// Why nobody knows for sure which node the strategy would hit; nothing if that is clear. Requests
// go to a name, signals to a process.
std::optional<std::string> doubt_of_identity(const Strategy& strategy, const Knowledge& knowledge);

}  // namespace culprit
