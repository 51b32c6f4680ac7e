// A component that lives in a container ends with it, and the program that starts the container loads it
// again. So the end of the container's process is one fault, and the components in it wait for its repair.
#pragma once

#include <optional>

#include "knowledge/knowledge.h"

namespace culprit {

// How long after its container's end a component waits for a rule that replaces the container to detect
// that; how long after the container's start to be loaded; and how long after that for its first
// message.
inline constexpr Duration kContainerDetected = std::chrono::seconds(3);
inline constexpr Duration kContainerLoads = std::chrono::seconds(10);
inline constexpr Duration kLoadedSpeaks = std::chrono::seconds(2);

// The container whose repair brings the component back. Empty: it lives in none, its container works
// and loaded it, or did not in time, or no strategy replaces the container.
std::optional<ComponentId> awaited_container(ComponentId component, const Knowledge& knowledge);

}  // namespace culprit
