#include "web/overview.h"

#include <algorithm>
#include <vector>

#include <fmt/core.h>

#include "knowledge/describe.h"
#include "knowledge/presence.h"
#include "web/component_health.h"

namespace culprit::web {
namespace {

std::string of_rules(std::size_t count) {
  return fmt::format("{} {}", count, count == 1 ? "rule" : "rules");
}

Overview of_incidents(const Manager& manager) {
  const std::vector<Incident>& all = manager.incidents().open();
  const Incident& first = all.front();
  Overview overview;
  overview.look = first.is_exhausted ? kHealthWords[4] : culprit::to_string(first.criticality);
  overview.headline = first.headline;
  if (all.size() > 1) overview.headline += fmt::format(", and {} more", all.size() - 1);
  overview.detail = manager.course_of(first).doing;
  return overview;
}

std::vector<std::string> missing_of(const Manager& manager) {
  const Knowledge& knowledge = manager.knowledge();
  std::vector<std::string> missing;
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    const ComponentState& state = knowledge.components[ComponentId(c)];
    const bool is_there = !state.is_missed && state.alive != false;
    if (knowledge.rules.components[c].is_required && !is_there)
      missing.push_back(knowledge.rules.components[c].name);
  }
  return missing;
}

// The first of the most critical.
RuleId worst_blind(const Knowledge& knowledge) {
  const std::vector<RuleId> blind = knowledge.blindness.rules();
  return *std::ranges::max_element(
      blind, {}, [&](RuleId id) { return knowledge.rules[id].policies.criticality; });
}

Overview of_blind(const Knowledge& knowledge) {
  const RuleId worst = worst_blind(knowledge);
  const std::size_t count = knowledge.blindness.count();
  const bool is_grave = knowledge.rules[worst].policies.criticality == Criticality::kError;
  Overview overview;
  overview.look = is_grave ? "BLIND_ERROR" : "BLIND";
  overview.headline =
      "no failure is seen, but " + (count == 1 ? knowledge.rules[worst].name + " is blind"
                                               : fmt::format("{} are blind", of_rules(count)));
  overview.detail = describe(*knowledge.blindness[worst]);
  return overview;
}

Overview of_watching_nothing(const Knowledge& knowledge) {
  if (knowledge.rules.rules.empty())
    return {"WATCHING_NOTHING", "watching nothing: there is no rule", "no failure can be seen"};
  return {"WATCHING_NOTHING", "watching nothing: no rule can see",
          describe(*knowledge.blindness[worst_blind(knowledge)])};
}

// While the /clock of a simulation stands still, no rule judges the nodes that live by it.
std::vector<std::string> held_in_time(const Knowledge& knowledge) {
  std::vector<std::string> held;
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    if (knowledge.components[ComponentId(c)].time_held)
      held.push_back(knowledge.rules.components[c].name);
  }
  return held;
}

Overview of_held(const std::vector<std::string>& held) {
  constexpr std::size_t kFew = 3;
  const std::string whose =
      held.size() <= kFew ? listed(held) : fmt::format("{} components", held.size());
  return {"TIME_HELD", "the simulated time of " + whose + " stands still",
          "/clock is paused: nothing is judged about them"};
}

std::string_view look_of(Presence presence) {
  switch (presence) {
    case Presence::kUnreachable:
      return "UNREACHABLE";
    case Presence::kDown:
      return "DEAD";
    case Presence::kHung:
      return "HUNG";
    case Presence::kStopped:
      return "STOPPED";
    case Presence::kNeverSeen:
    case Presence::kNotSeenYet:
      return "NEVER_SEEN";
    case Presence::kUnknown:
    case Presence::kStarting:
      return "BLIND";
    case Presence::kThere:
      break;
  }
  return "OK";
}

// Says what to do about it.
const char* remedy_of(Presence presence) {
  switch (presence) {
    case Presence::kNeverSeen:
      return "no failure is seen; was it started, and is its NODE right?";
    case Presence::kNotSeenYet:
      return "no failure is seen; discovery goes on";
    case Presence::kUnknown:
      return "no failure is seen, and its health is unknown";
    case Presence::kUnreachable:
      return "no failure is seen; culprit receives nothing from its host";
    default:
      return "no rule reports it as a failure";
  }
}

Overview of_absence(const Absence& absence, const Knowledge& knowledge) {
  return {look_of(absence.how), describe(absence, knowledge.rules), remedy_of(absence.how)};
}

}  // namespace

Overview overview_of(const Manager& manager) {
  const Knowledge& knowledge = manager.knowledge();
  if (!manager.incidents().open().empty()) return of_incidents(manager);
  if (!manager.hears())
    return {"DEAF", "culprit does not receive the robot's messages",
            "nothing is judged, and nothing is done"};
  if (const auto missing = missing_of(manager); !missing.empty())
    return {"MISSING",
            listed(missing) + (missing.size() == 1 ? " is REQUIRED and is not there"
                                                   : " are REQUIRED and are not there"),
            "no rule sees a failure"};
  if (const auto held = held_in_time(knowledge); !held.empty()) return of_held(held);
  if (knowledge.blindness.is_total()) return of_watching_nothing(knowledge);
  if (knowledge.blindness.count() > 0) return of_blind(knowledge);
  if (const auto absence = worst_absence(knowledge)) return of_absence(*absence, knowledge);
  return {"OK", "all is well", "no failure is seen by " + of_rules(knowledge.rules.rules.size())};
}

ComponentLook look_of(ComponentId id, std::size_t health, const Manager& manager) {
  const Knowledge& knowledge = manager.knowledge();
  ComponentLook look{kHealthWords[health], ""};
  if (const Presence presence = presence_of(id, knowledge); presence != Presence::kThere) {
    look = {look_of(presence), to_string(presence)};
  } else if (knowledge.components[id].time_held) {
    look = {"TIME_HELD", "clock paused"};
  } else if (health == 0) {
    const auto about = knowledge.states.touching(id);
    const bool is_seen =
        std::ranges::any_of(about, [&](RuleId rule) { return !knowledge.blindness[rule]; });
    if (about.empty()) look = {"UNWATCHED", "no rule"};
    if (!about.empty() && (!is_seen || !manager.hears())) look = {"BLIND", "blind"};
  }
  if (health > 0) look.look = kHealthWords[health];
  return look;
}

Json to_json(const Overview& overview) {
  return {{"look", overview.look}, {"headline", overview.headline}, {"detail", overview.detail}};
}

}  // namespace culprit::web
