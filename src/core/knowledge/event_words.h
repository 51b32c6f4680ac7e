// The name of each event wherever it is reported: in the journal, at the terminal, on the page, on
// /rosout.
//
//     words_of(event).label                    // "decided"
//     words_of<StrategyChosen>().name          // "strategy_chosen"
//     severity_of(event, rules)                // EventSeverity::kInfo
//
// One table (event_words.cpp) has a row for each event of the variant. One that is missing there
// does not compile. The sentence that goes with an event is describe()'s.
#pragma once

#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>

#include "knowledge/event.h"

namespace culprit {

enum class EventSeverity : std::uint8_t { kInfo, kWarning, kError };

// The colour, for example, in which people see it at first glance.
enum class Tone : std::uint8_t {
  kAside,    // no action, or not reported
  kAlarm,    // something is broken, or stays broken
  kWarning,  // something did not go as it should
  kRelief,   // something is well again
  kAction,   // culprit does something about it
  kPerson    // people asked for it, or are asked
};
enum class Weight : std::uint8_t { kPlain, kStrong };

struct EventWords {
  std::string_view name;   // "strategy_chosen": in journals, where it must not change, and in JSON
  std::string_view label;  // "decided": before its sentence; at most 10 characters
  EventSeverity severity = EventSeverity::kInfo;
  Tone tone = Tone::kAside;
  Weight weight = Weight::kPlain;
};

// The kinds of events by their place in the variant.
using EventKind = std::size_t;

template <class What, class... All>
consteval EventKind place_in(std::type_identity<std::variant<All...>>) {
  EventKind place = 0;
  (void)((std::is_same_v<What, All> || (++place, false)) || ...);
  return place;
}
template <class What>
inline constexpr EventKind kKindOf = place_in<What>(std::type_identity<EventWhat::Variant>());

const EventWords& words_of(EventKind kind);
inline const EventWords& words_of(const Event& event) { return words_of(event.what.index()); }
template <class What>
const EventWords& words_of() {
  return words_of(kKindOf<What>);
}

// Empty if no event has this name.
std::optional<EventKind> kind_named(std::string_view name);

// Its severity in the table, and an error if it is about a REQUIRED component that is not there.
EventSeverity severity_of(const Event& event, const RuleSet& rules);

std::string_view to_string(EventSeverity severity);  // "info", "warning", "error"
std::string_view to_string(Tone tone);               // "alarm", "relief" ...

}  // namespace culprit
