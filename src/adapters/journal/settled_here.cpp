#include "journal/settled_here.h"

#include "base/invariant.h"

namespace culprit::journal {
namespace {

bool can_be_read_back(AdaptationType type) {
  switch (type) {
    case AdaptationType::kCall:
    case AdaptationType::kIncreaseParameter:
    case AdaptationType::kDecreaseParameter:
      return false;
    case AdaptationType::kSetParameter:
    case AdaptationType::kChangeCommunication:
    case AdaptationType::kChangeMode:
    case AdaptationType::kActivate:
    case AdaptationType::kDeactivate:
    case AdaptationType::kRestart:
    case AdaptationType::kRedeploy:
    case AdaptationType::kStart:
    case AdaptationType::kStop:
    case AdaptationType::kStartGroup:
      return true;
  }
  return false;
}

// Its process is known by its number here. A container's is not, nor is another machine's.
bool runs_here(ComponentId component, const Knowledge& knowledge) {
  return knowledge.rules[component].host().empty() &&
         knowledge.components[component].known_pid() != 0;
}

}  // namespace

bool is_settled_here(const Command& command, const Knowledge& knowledge) {
  CULPRIT_ASSERT(!is_read(command));
  const Strategy& strategy = knowledge.rules[command.purpose.strategy];
  CULPRIT_ASSERT(command.purpose.adaptation < strategy.adaptations.size());
  return can_be_read_back(strategy.adaptations[command.purpose.adaptation].type) &&
         runs_here(command.component, knowledge);
}

}  // namespace culprit::journal
