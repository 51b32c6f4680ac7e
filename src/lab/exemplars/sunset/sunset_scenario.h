// The faults of SUNSET: the ten faults, the 18 combinations of them that the exemplar's evaluation
// plays, and the process faults of our demonstrations.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "base/value.h"
#include "exemplars/sunset/members.h"
#include "language/rule_set.h"

namespace culprit::sunset {

// F1 to F5 of the paper.
enum class Failure : std::uint8_t {
  kCameraOutage,
  kFusionOutage,
  kSegmentationOutage,
  kPoorSegmentation,
  kBlurredPicture
};

// A parameter that is set to a bad value.
struct Fault {
  std::string_view name;  // of the parameter
  Member member;
  Value value;    // the scenarios'
  Value healthy;  // that ends it
  Criticality criticality;
  // As what it shows: its own failure first, then those that follow downstream. Empty for
  // depth_degradation, whose noise does not make the segmentation unsure.
  std::vector<Failure> failures;
  // The strategies of rules/sunset.rules any of which ends its failures.
  std::vector<std::string_view> resolved_by;
};

// Three warnings, six failures and the autofocus, in the exemplar's order.
std::span<const Fault> faults();

// Null if there is none of this name.
const Fault* find_fault(std::string_view name);

// One warning, one failure and the autofocus at once.
struct Scenario {
  int number = 1;  // 1..18, the exemplar's index of its first repetition
  // In the exemplar's order of injection: failure, warning, autofocus.
  std::array<const Fault*, 3> faults;

  std::string label() const;  // "001"
  std::string name() const;   // "image_degradation+camera_driver_issue"
};

std::vector<Scenario> scenarios();

// By label or by name. An error says which there are.
Expected<Scenario> find_scenario(std::string_view label_or_name);

// A fault of a process that no parameter shows.
enum class ProcessFault : std::uint8_t {
  kKill,         // SIGKILL
  kStop,         // SIGSTOP: it is there, and does nothing
  kCrashAtStart  // killed, and its next two starts fail (crash_at_start.h)
};

}  // namespace culprit::sunset
