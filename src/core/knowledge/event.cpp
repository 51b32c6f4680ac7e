#include "knowledge/event.h"

namespace culprit {

EventWhat::EventWhat() = default;
EventWhat::EventWhat(const EventWhat& other) = default;
EventWhat::EventWhat(EventWhat&& other) noexcept = default;
EventWhat& EventWhat::operator=(const EventWhat& other) = default;
EventWhat& EventWhat::operator=(EventWhat&& other) noexcept = default;
EventWhat::~EventWhat() = default;

std::string_view to_string(IncidentEnd how) {
  switch (how) {
    case IncidentEnd::kResolved:
      return "resolved";
    case IncidentEnd::kLost:
      return "lost";
    case IncidentEnd::kMerged:
      return "merged";
  }
  return "";
}

}  // namespace culprit
