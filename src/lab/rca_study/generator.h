// Random scenarios on graphs like those of ROS 2 robots.
//
// Layers of components, from drivers to outputs: each reads topics of the one or two layers before
// it, some of which have many readers. Beside that
//   - redundant sources: a component that can do with either of two topics;
//   - feedback (if cyclic, from two components on): a topic that goes back one to three layers;
//   - infrastructure: /tf and the like, which a few components publish and many read, and a monitor
//     that reads what most publish and tells many. No failure passes through them.
// Sizes in use: 5 (SUNSET), 20 (Nav2), 200 and 300 (Autoware), up to 10,000.
#pragma once

#include "rca_study/factors.h"
#include "rca_study/rca_scenario.h"

namespace culprit::study::rca {

struct RcaSetting {
  std::size_t components = 200;
  std::size_t faults =
      3;             // at once, each on a component of its own; at most one for each component
  double noise = 0;  // of each reading: the probability of a miss, and of a false alarm
  bool is_cyclic = false;
  bool has_mixed_levels = false;  // each rule's criticality is any; else all are ERROR
  // The planners' information is true: every strategy helps as often as the rules say, every
  // subscription passes failures on as often as any other, and none is redundant.
  bool is_as_told = false;
  bool is_flapping = false;       // every fault comes and goes; else any is of any kind
  bool has_unfixable = false;     // nothing helps against one of the faults
  bool ignores_plumbing = false;  // the rules' author knows the infrastructure, and ignores it
  RcaFactors factors{};

  bool operator==(const RcaSetting&) const = default;
};

// As many faults on components of such a robot.
std::vector<InjectedFault> random_faults(const RcaSetting& setting, std::uint64_t seed);

RcaScenario generate(const RcaSetting& setting, std::uint64_t seed);

}  // namespace culprit::study::rca
