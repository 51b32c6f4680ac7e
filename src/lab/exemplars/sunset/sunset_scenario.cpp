#include "exemplars/sunset/sunset_scenario.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>

namespace culprit::sunset {
namespace {

constexpr std::size_t kWarnings = 3;
constexpr std::size_t kFailures = 6;

Fault outage(std::string_view name, Member member, std::vector<Failure> failures,
             std::vector<std::string_view> resolved_by) {
  return {
      name, member, true, false, Criticality::kError, std::move(failures), std::move(resolved_by)};
}

std::vector<Fault> make_faults() {
  using enum Failure;
  const std::vector<Failure> camera = {kCameraOutage, kFusionOutage, kSegmentationOutage};
  const std::vector<Failure> fusion = {kFusionOutage, kSegmentationOutage};
  const std::vector<Failure> segmentation = {kSegmentationOutage};
  return {
      {"image_degradation",
       Member::kCamera,
       1.5,
       0.0,
       Criticality::kWarning,
       {kPoorSegmentation},
       {"enhancement_activate"}},
      {"depth_degradation", Member::kDepth, 2.0, 0.0, Criticality::kWarning, {}, {}},
      {"image_shift",
       Member::kSensorFusion,
       std::int64_t{300},
       std::int64_t{0},
       Criticality::kWarning,
       {kPoorSegmentation},
       {"recalibration"}},

      outage("camera_driver_issue", Member::kCamera, camera, {"rgb_restart", "rgb_redeploy"}),
      outage("sync_issue", Member::kSensorFusion, fusion, {"fusion_restart", "fusion_redeploy"}),
      outage("cuda_out_of_memory", Member::kSegmentation, segmentation,
             {"segmentation_restart", "segmentation_redeploy"}),
      outage("hardware_disconnect", Member::kCamera, camera, {"rgb_redeploy"}),
      outage("memory_leakage", Member::kSensorFusion, fusion, {"fusion_redeploy"}),
      outage("gpu_failure", Member::kSegmentation, segmentation, {"segmentation_redeploy"}),

      {"autofocus_needed",
       Member::kCamera,
       true,
       false,
       Criticality::kNonCritical,
       {kBlurredPicture},
       {"autofocus"}},
  };
}

Scenario make_scenario(std::size_t index) {
  const std::span<const Fault> all = faults();
  return {static_cast<int>(index) + 1,
          {&all[kWarnings + index % kFailures], &all[index / kFailures], &all.back()}};
}

}  // namespace

std::span<const Fault> faults() {
  static const std::vector<Fault> kFaults = make_faults();
  return kFaults;
}

const Fault* find_fault(std::string_view name) {
  const auto all = faults();
  const auto found = std::ranges::find(all, name, &Fault::name);
  return found == all.end() ? nullptr : &*found;
}

std::string Scenario::label() const {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%03d", number);
  return text.data();
}

std::string Scenario::name() const {
  return std::string(faults[1]->name) + "+" + std::string(faults[0]->name);
}

std::vector<Scenario> scenarios() {
  std::vector<Scenario> all;
  for (std::size_t index = 0; index < kWarnings * kFailures; ++index) {
    all.push_back(make_scenario(index));
  }
  return all;
}

Expected<Scenario> find_scenario(std::string_view label_or_name) {
  for (Scenario& scenario : scenarios()) {
    if (scenario.label() == label_or_name || scenario.name() == label_or_name) return scenario;
  }
  return Error{"there is no scenario '" + printable(label_or_name) +
               "'; there are 001 to 018, or by name, such as " + scenarios().front().name()};
}

}  // namespace culprit::sunset
