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

namespace culprit::execute {

// The reason why a component that the strategy restarts or redeploys is not broken; empty if there is none.
//
// The failure may show by itself that the component is well (blameless.h). Otherwise only an outage needs agreement. A rule whose trigger reads a value (a quality, a diagnostic, a
// parameter) has itself measured that something works badly, and its author names the component to
// redeploy. A last resort and `stop` blame no component, so they need none either.
std::optional<std::string> contradiction(const Strategy& strategy, const Knowledge& knowledge,
                                         Time now);

// It is probed, answered before, and its answer is overdue.
bool owes_answer(const ComponentState& state, Time now);

// It will be known soon whether a component hangs that the strategy ends or takes through its
// lifecycle: its answer is overdue, or it did not answer since the rule's topics fell silent. A
// component that hangs gets no SIGTERM first, and no other request; after a SIGTERM it is too late
// to find out. Empty: it answers, or is never asked. A last resort does not wait.
struct AnswerToCome {
  std::string reason;
  Time until;
};
std::optional<AnswerToCome> answer_to_come(const Strategy& strategy, const Knowledge& knowledge,
                                           Time now);

// The strategy would activate or replace a node that has just come up and is activated by itself or by its
// launcher, as before. Two drivers of one lifecycle make each other fail. Empty: there is no such node. A simulated
// robot knows no such wait.
std::optional<AnswerToCome> driver_to_come(const Strategy& strategy, const Knowledge& knowledge,
                                           Time now);

// The reason if it would start a component that was never seen (knowledge/discovered.h); else empty.
// An absent node has not failed, and only people and `run --launch` start components that were not there.
std::optional<std::string> launch_of_the_unseen(const Strategy& strategy,
                                                const Knowledge& knowledge);

// The reason if it is uncertain which node the strategy would hit; else empty. Requests go to a
// name, signals to a process.
std::optional<std::string> doubt_of_identity(const Strategy& strategy, const Knowledge& knowledge);

}  // namespace culprit::execute
