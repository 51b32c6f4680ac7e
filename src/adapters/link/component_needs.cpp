#include "link/component_needs.h"

#include <algorithm>

namespace culprit::link {
namespace {

void add(const Adaptation& adaptation, ComponentNeeds& needs) {
  switch (adaptation.type) {
    case AdaptationType::kSetParameter:
    case AdaptationType::kIncreaseParameter:
    case AdaptationType::kDecreaseParameter:
    case AdaptationType::kChangeCommunication:
      needs.sets_parameters = true;
      return;
    case AdaptationType::kRedeploy:
      needs.is_to_answer = true;
      needs.changes_lifecycle = true;
      return;
    case AdaptationType::kActivate:
    case AdaptationType::kDeactivate:
    case AdaptationType::kRestart:
    case AdaptationType::kStart:
      needs.changes_lifecycle = true;
      return;
    case AdaptationType::kChangeMode:
      needs.changes_modes = true;
      return;
    case AdaptationType::kCall:
      needs.routines.push_back(adaptation.subject);
      return;
    case AdaptationType::kStop:
    case AdaptationType::kStartGroup:  // a rule set holds its parts instead
      return;
  }
}

}  // namespace

ComponentNeeds needs_of(ComponentId component, const RuleSet& rules) {
  ComponentNeeds needs;
  for (const Strategy& strategy : rules.strategies) {
    for (const Adaptation& adaptation : strategy.adaptations) {
      if (adaptation.component == component) add(adaptation, needs);
    }
  }
  for (const Input& input : rules.inputs)
    needs.is_to_answer |= input.kind == Input::Kind::kAlive && input.component == component;
  for (const Group& group : rules.groups) {
    const bool is_member = std::ranges::find(group.members, component) != group.members.end();
    needs.is_to_answer |= is_member || group.manager == component;
  }
  return needs;
}

}  // namespace culprit::link
