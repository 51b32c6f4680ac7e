#include "rca_study/rca_scenario.h"

namespace culprit::study::rca {

std::string_view to_string(FaultKind kind) {
  constexpr std::array<std::string_view, kFaultKinds> kNames = {
      "silent", "slow", "degraded", "flapping", "crash", "hang", "wrong_parameter"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string_view to_string(Repair repair) {
  constexpr std::array<std::string_view, kRepairs> kNames = {"configure", "restart", "redeploy"};
  return kNames[static_cast<std::size_t>(repair)];
}

}  // namespace culprit::study::rca
