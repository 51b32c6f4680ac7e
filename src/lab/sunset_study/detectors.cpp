#include "sunset_study/detectors.h"

#include <array>

namespace culprit::study {
namespace {

using Replacement = std::pair<std::string_view, std::string_view>;

constexpr std::array kPhis = {
    Replacement{"CONST silence       = 350ms\n", "CONST suspicion     = 8\n"},
    Replacement{"age(", "phi("},
    Replacement{"> silence", "> suspicion"},
};

// A parameter is read once a cycle; the impacts are as many cycles more as those are shorter.
constexpr std::array kFaults = {
    Replacement{"CYCLE 200ms", "CYCLE 40ms"},
    Replacement{"restart 3\n", "restart 15\n"},
    Replacement{"redeploy 10\n", "redeploy 50\n"},
    Replacement{" 5\n", " 25\n"},
    Replacement{" 7\n", " 35\n"},
    Replacement{"SIGNAL autofocus_needed ",
                "SIGNAL camera_driver_issue  PARAMETER camera camera_driver_issue\n"
                "SIGNAL hardware_disconnect  PARAMETER camera hardware_disconnect\n"
                "SIGNAL sync_issue           PARAMETER fusion sync_issue\n"
                "SIGNAL memory_leakage       PARAMETER fusion memory_leakage\n"
                "SIGNAL cuda_out_of_memory   PARAMETER segmentation cuda_out_of_memory\n"
                "SIGNAL gpu_failure          PARAMETER segmentation gpu_failure\n"
                "SIGNAL autofocus_needed "},
    Replacement{"age(/managed_subsystem/rgb_camera) > silence",
                "camera_driver_issue || hardware_disconnect"},
    Replacement{"age(/managed_subsystem/sensors_fused) > silence", "sync_issue || memory_leakage"},
    Replacement{"age(/managed_subsystem/segmentation) > silence",
                "cuda_out_of_memory || gpu_failure"},
};

void replace_all(std::string& text, const Replacement& change) {
  for (std::size_t at = text.find(change.first); at != std::string::npos;
       at = text.find(change.first, at + change.second.size()))
    text.replace(at, change.first.size(), change.second);
}

}  // namespace

Expected<std::pair<std::string, Detectors>> parse_profile(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string profile(text.substr(0, colon));
  if (colon == std::string_view::npos) return std::pair(profile, Detectors::kOwn);
  const std::string_view detectors = text.substr(colon + 1);
  if (detectors == "age") return std::pair(profile, Detectors::kAge);
  if (detectors == "phi") return std::pair(profile, Detectors::kPhi);
  if (detectors == "known") return std::pair(profile, Detectors::kKnown);
  return Error{"there are no detectors '" + std::string(detectors) +
               "'; there are own, age, phi, known"};
}

std::string with_phi(std::string text) {
  for (const Replacement& change : kPhis) replace_all(text, change);
  return text;
}

std::string with_faults_known(std::string text) {
  for (const Replacement& change : kFaults) replace_all(text, change);
  return text;
}

}  // namespace culprit::study
