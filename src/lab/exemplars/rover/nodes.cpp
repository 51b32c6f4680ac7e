#include "exemplars/rover/nodes.h"

#include <algorithm>
#include <array>

namespace culprit::rover {

std::span<const Process> processes() {
  static const Process kLocalizer = {"lifecycle_manager_localization", nullptr};
  static const Process kNavigator = {"lifecycle_manager_navigation", nullptr};
  const auto list = [](const auto&... all) { return std::array{all...}; };
  static const std::array kAll =
      list(kWorld, kLidarDriver, kPerceptionContainer, kCameraDriver, kCloudMaker, kImuDriver,
           kBaseDriver, kMapServer, kAmcl, kPlannerServer, kControllerServer, kBehaviorServer,
           kVelocitySmoother, kBtNavigator, kTwistMux, kEStop, kLocalizer, kNavigator, kMission);
  return kAll;
}

bool is_server(std::string_view node) {
  return std::ranges::find(kLocalization, node) != std::end(kLocalization) ||
         std::ranges::find(kNavigation, node) != std::end(kNavigation);
}

}  // namespace culprit::rover
