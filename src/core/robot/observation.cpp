#include "robot/observation.h"

namespace culprit {

ObservationWhat::ObservationWhat() = default;
ObservationWhat::ObservationWhat(const ObservationWhat& other) = default;
ObservationWhat::ObservationWhat(ObservationWhat&& other) noexcept = default;
ObservationWhat& ObservationWhat::operator=(const ObservationWhat& other) = default;
ObservationWhat& ObservationWhat::operator=(ObservationWhat&& other) noexcept = default;
ObservationWhat::~ObservationWhat() = default;

}  // namespace culprit
