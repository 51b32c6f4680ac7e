#include "knowledge/event.h"

namespace culprit {

EventWhat::EventWhat() = default;
EventWhat::EventWhat(const EventWhat& other) = default;
EventWhat::EventWhat(EventWhat&& other) noexcept = default;
EventWhat& EventWhat::operator=(const EventWhat& other) = default;
EventWhat& EventWhat::operator=(EventWhat&& other) noexcept = default;
EventWhat::~EventWhat() = default;

}  // namespace culprit
