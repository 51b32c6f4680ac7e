#include "knowledge/event_words.h"

#include <array>

namespace culprit {
namespace {

constexpr std::size_t kKinds = std::variant_size_v<EventWhat::Variant>;

struct Row {
  EventKind kind;
  EventWords words;
};

template <class What>
consteval Row row(std::string_view name, std::string_view label, EventSeverity severity, Tone tone,
                  Weight weight = Weight::kPlain) {
  return {kKindOf<What>, {name, label, severity, tone, weight}};
}

// clang-format off
constexpr std::array<EventWords, kKinds> kWords = [] {
  using enum EventSeverity;
  using enum Weight;
  constexpr Row kRows[] = {
      row<FailureDetected>("failure_detected", "detected", kWarning, Tone::kAlarm, kStrong),
      row<FailureResolved>("failure_resolved", "resolved", kInfo, Tone::kRelief, kStrong),
      row<FailureLost>("failure_lost", "lost sight", kInfo, Tone::kWarning),
      row<FailureHeldBack>("failure_held_back", "waiting", kInfo, Tone::kAside),
      row<FailureFlaps>("failure_flaps", "FLAPPING", kError, Tone::kAlarm, kStrong),
      row<StrategyChosen>("strategy_chosen", "decided", kInfo, Tone::kAction, kStrong),
      row<StrategyFailed>("strategy_failed", "no help", kWarning, Tone::kWarning),
      row<StrategyResumed>("strategy_resumed", "resumed", kInfo, Tone::kAction),
      row<StrategyAbandoned>("strategy_abandoned", "abandoned", kWarning, Tone::kWarning),
      row<AdaptationDone>("adaptation_done", "done", kInfo, Tone::kAction),
      row<AdaptationFailed>("adaptation_failed", "failed", kWarning, Tone::kWarning),
      row<Undone>("undone", "undone", kInfo, Tone::kAction),
      row<RoundSpent>("round_spent", "all tried", kInfo, Tone::kWarning),
      row<LastResortReached>("last_resort_reached", "LAST", kError, Tone::kAlarm, kStrong),
      row<LastResortDone>("last_resort_done", "stays", kWarning, Tone::kAction, kStrong),
      row<RuleExhausted>("rule_exhausted", "EXHAUSTED", kError, Tone::kAlarm, kStrong),
      row<ComponentLost>("component_lost", "lost", kWarning, Tone::kAlarm),
      row<ComponentFound>("component_found", "found", kInfo, Tone::kRelief),
      row<StaysDown>("stays_down", "stays down", kWarning, Tone::kPerson, kStrong),
      row<NeverSeen>("never_seen", "never seen", kWarning, Tone::kWarning),
      row<RuleBlind>("rule_blind", "BLIND", kWarning, Tone::kWarning, kStrong),
      row<RuleSees>("rule_sees", "sees", kInfo, Tone::kRelief),
      row<LifecycleIntended>("lifecycle_intended", "lifecycle", kInfo, Tone::kAside),
      row<CameUp>("came_up", "came up", kInfo, Tone::kAside),
      row<RivalSeen>("rival_seen", "RIVAL", kWarning, Tone::kWarning, kStrong),
      row<Trouble>("trouble", "trouble", kWarning, Tone::kWarning),
      row<OrderAccepted>("order_accepted", "order", kInfo, Tone::kPerson, kStrong),
      row<OrderRefused>("order_refused", "refused", kInfo, Tone::kPerson),
      row<OrderCarriedOut>("order_carried_out", "done", kInfo, Tone::kAction),
      row<ActionHeldBack>("action_held_back", "held back", kWarning, Tone::kWarning),
      row<ApprovalAsked>("approval_asked", "APPROVE?", kWarning, Tone::kPerson, kStrong),
      row<ApprovalLapsed>("approval_lapsed", "lapsed", kInfo, Tone::kPerson),
      row<SilenceEnded>("silence_ended", "unmuted", kInfo, Tone::kPerson),
      row<StormBegan>("storm_began", "STORM", kError, Tone::kAlarm, kStrong),
      row<StormEnded>("storm_ended", "calm", kInfo, Tone::kRelief),
      row<OutcomePending>("outcome_pending", "pending", kInfo, Tone::kAside),
      row<OutcomeCounted>("outcome_counted", "learned", kInfo, Tone::kAside),
      row<JudgementSuspended>("judgement_suspended", "DEAF", kError, Tone::kAlarm, kStrong),
      row<JudgementResumed>("judgement_resumed", "hears", kInfo, Tone::kRelief),
      row<SleepNoticed>("sleep_noticed", "slept", kWarning, Tone::kWarning),
      row<HostSilent>("host_silent", "HOST DOWN", kError, Tone::kAlarm, kStrong),
      row<HostBack>("host_back", "host back", kInfo, Tone::kRelief),
      row<ValueUnknown>("value_unknown", "unknown", kWarning, Tone::kWarning),
      row<IncidentOpened>("incident_opened", "incident", kInfo, Tone::kAside),
      row<IncidentChanged>("incident_changed", "incident", kInfo, Tone::kAside),
      row<IncidentClosed>("incident_closed", "incident", kInfo, Tone::kAside),
      row<PriorsAdopted>("priors_adopted", "fleet", kInfo, Tone::kAside),
  };
  static_assert(std::size(kRows) == kKinds, "an event without words, or one that is there twice");
  std::array<EventWords, kKinds> words{};
  for (const Row& each : kRows) words[each.kind] = each.words;
  return words;
}();
// clang-format on

// Otherwise one event stands in two rows, and another in none; or two events have one name.
consteval bool has_each_event_a_name_of_its_own() {
  for (std::size_t i = 0; i < kKinds; ++i) {
    if (kWords[i].name.empty() || kWords[i].label.size() > 10) return false;
    for (std::size_t j = 0; j < i; ++j) {
      if (kWords[j].name == kWords[i].name) return false;
    }
  }
  return true;
}
static_assert(has_each_event_a_name_of_its_own());

bool is_required(const ComponentId* component, const RuleSet& rules) {
  return component != nullptr && rules[*component].is_required;
}

bool misses_what_is_required(const Event& event, const RuleSet& rules) {
  if (const auto* lost = std::get_if<ComponentLost>(&event.what))
    return is_required(&lost->component, rules);
  const auto* unseen = std::get_if<NeverSeen>(&event.what);
  return unseen != nullptr && is_required(std::get_if<ComponentId>(&unseen->what), rules);
}

}  // namespace

const EventWords& words_of(EventKind kind) { return kWords[kind]; }

std::optional<EventKind> kind_named(std::string_view name) {
  for (EventKind kind = 0; kind < kKinds; ++kind) {
    if (kWords[kind].name == name) return kind;
  }
  return std::nullopt;
}

EventSeverity severity_of(const Event& event, const RuleSet& rules) {
  return misses_what_is_required(event, rules) ? EventSeverity::kError : words_of(event).severity;
}

std::string_view to_string(EventSeverity severity) {
  switch (severity) {
    case EventSeverity::kInfo:
      return "info";
    case EventSeverity::kWarning:
      return "warning";
    case EventSeverity::kError:
      return "error";
  }
  return "";
}

std::string_view to_string(Tone tone) {
  switch (tone) {
    case Tone::kAside:
      return "aside";
    case Tone::kAlarm:
      return "alarm";
    case Tone::kWarning:
      return "warning";
    case Tone::kRelief:
      return "relief";
    case Tone::kAction:
      return "action";
    case Tone::kPerson:
      return "person";
  }
  return "";
}

}  // namespace culprit
