#include "knowledge/presence.h"

#include "knowledge/describe.h"

namespace culprit {

Presence presence_of(ComponentId id, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[id];
  if (knowledge.is_unheard(id) && !state.time_held) return Presence::kUnreachable;
  if (state.process == ProcessState::kStopped && state.alive) return Presence::kStopped;
  if (state.alive && state.hangs()) return Presence::kHung;
  if (state.alive == false) return Presence::kDown;
  if (state.alive || knowledge.graph.is_present(id)) return Presence::kThere;
  if (!knowledge.discovered.has(id))
    return state.is_missed ? Presence::kNeverSeen : Presence::kNotSeenYet;
  return state.is_coming_up() ? Presence::kStarting : Presence::kUnknown;
}

std::string_view to_string(Presence presence) {
  switch (presence) {
    case Presence::kUnreachable:
      return "unreachable";
    case Presence::kDown:
      return "down";
    case Presence::kHung:
      return "hung";
    case Presence::kStopped:
      return "stopped";
    case Presence::kNeverSeen:
      return "never seen";
    case Presence::kNotSeenYet:
      return "not seen yet";
    case Presence::kUnknown:
      return "unknown";
    case Presence::kStarting:
      return "starting";
    case Presence::kThere:
      break;
  }
  return "";
}

std::optional<Absence> worst_absence(const Knowledge& knowledge) {
  std::optional<Absence> worst;
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    const Presence how = presence_of(ComponentId(c), knowledge);
    if (how >= Presence::kStarting || (worst && how > worst->how)) continue;
    if (!worst || how < worst->how) worst = Absence{how, {}};
    worst->who.emplace_back(c);
  }
  return worst;
}

std::string describe(const Absence& absence, const RuleSet& rules) {
  constexpr std::size_t kFew = 3;
  std::vector<std::string> names;
  for (const ComponentId id : absence.who) names.push_back(rules[id].name);
  const std::size_t count = names.size();
  const std::string who = count <= kFew ? listed(names) : std::to_string(count) + " components";
  const char* const verb = absence.how == Presence::kNeverSeen ? (count == 1 ? " was " : " were ")
                           : count == 1                        ? " is "
                                                               : " are ";
  const std::string how(to_string(absence.how));
  return who + verb + (absence.how == Presence::kUnknown ? "in an unknown state" : how);
}

}  // namespace culprit
