#include "exemplars/rover/nodes.h"

#include <algorithm>

namespace culprit::rover {

std::span<const Process> processes() {
  static const Process kAll[] = {kWorld,
                                 kLidarDriver,
                                 kCameraDriver,
                                 kImuDriver,
                                 kBaseDriver,
                                 kMapServer,
                                 kAmcl,
                                 kPlannerServer,
                                 kControllerServer,
                                 kBehaviorServer,
                                 kVelocitySmoother,
                                 kBtNavigator,
                                 kTwistMux,
                                 kEStop,
                                 {"lifecycle_manager_localization", nullptr},
                                 {"lifecycle_manager_navigation", nullptr},
                                 kMission};
  return kAll;
}

bool is_server(std::string_view node) {
  return std::ranges::find(kLocalization, node) != std::end(kLocalization) ||
         std::ranges::find(kNavigation, node) != std::end(kNavigation);
}

}  // namespace culprit::rover
