#include "live/black_box.h"

#include "base/live_clock.h"
#include "journal/event_json.h"

namespace culprit::live {
namespace {

// Seconds since 1970, to the millisecond, as everywhere else that people read events.
double clock_now() {
  constexpr std::int64_t kMillisecond = 1'000'000;
  return static_cast<double>(wall_now() / kMillisecond) / 1000;
}

}  // namespace

void BlackBox::begins(const Manager& manager, std::function<Remarks()> /*remarks*/,
                      Time /*start*/) {
  manager_ = &manager;
  // The recorder finds all current incidents again.
  recorder_.over();
}

void BlackBox::stepped(const Runtime::Step& step) {
  if (step.events.empty()) return;
  const Knowledge& knowledge = manager_->knowledge();
  for (const Event& event : step.events) {
    Json json = journal::to_json(event, knowledge.rules);
    if (journal::text_of(json, "text").empty() && !json.contains("incident")) continue;
    json["clock"] = clock_now();
    recorder_.note_event(to_line(json));
    if (const auto* detected = std::get_if<FailureDetected>(&event.what))
      recorder_.begin(knowledge.rules[detected->rule].name);
  }
  if (knowledge.states.active().empty()) recorder_.over();
}

void BlackBox::announced(Time /*at*/, const EventWords& words, const std::string& text) {
  recorder_.note_event(to_line({{"type", words.name}, {"text", text}, {"clock", clock_now()}}));
}

}  // namespace culprit::live
