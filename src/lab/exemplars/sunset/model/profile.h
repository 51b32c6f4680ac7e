// Which SUNSET is modelled. The public sources show three, which differ in what an evaluation
// measures; and there is ours, which runs live.
//
// All times are robot time, the bag's. The exemplar plays its bag at a fifth of real time, so that
// a second on the wall is 0.2 s here.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "base/expected.h"
#include "base/units.h"
#include "simulation/node.h"

namespace culprit::sunset::model {

// How an unwell picture shows in the entropy, which is a first-order autoregressive process, cut
// off at `least` and `most`.
struct EntropyLevel {
  double least = 0;
  double mean = 0;
  double most = 0;
  double deviation = 0;
};

struct Profile {
  std::string_view name;
  std::string_view summary;

  // ---- the nodes
  simulation::Span start;            // launching a node, until it is in the graph
  Duration configure{};              // what configuring blocks camera, fusion and segmentation
  Duration model_loading{};          // more of it in the segmentation
  Duration sensor_activation{};      // camera and depth: from configured to active
  Duration processing_activation{};  // fusion and segmentation: the same
  simulation::Span end;              // from the shutdown to the end of the process
  Duration inference{};              // of one picture by the segmentation
  Duration focusing{};               // per frame, by a camera that needs to focus
  std::size_t fusion_keeps = 6;      // pictures of each input; 1: only the newest
  bool keeps_parameters = true;      // what was set outlives the process
  bool activation_restores_brightness = false;  // of the camera: clears image_degradation

  // ---- the blackboard, SUNSET's own monitoring
  bool has_blackboard = true;
  std::size_t frequency_window = 4;  // arrivals
  Duration blackboard_period{};
  Duration alarmed_period{};  // from the first time on that two entries look bad; 0: the same

  // ---- the evaluation
  Duration manager_start{};     // after the bag's
  simulation::Span injection;   // of the first fault, after the bag's start
  Duration injection_jitter{};  // the three faults are set by processes that race each other
  Duration end_of_run{};        // after the injection
};

// "paper", "head", "october", "live". The first is what the published figures fit best.
std::span<const Profile> profiles();

// An error says which there are.
Expected<const Profile*> find_profile(std::string_view name);

}  // namespace culprit::sunset::model
