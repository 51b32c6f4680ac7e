#include "exemplars/sunset/model/image_enhancement.h"

namespace culprit::sunset::model {
namespace {

simulation::NodeTraits idle(const Profile& profile) {
  simulation::NodeTraits traits;
  traits.start = profile.start;
  traits.starts_as = Lifecycle::kInactive;
  traits.end = profile.end;
  return traits;
}

}  // namespace

ImageEnhancement::ImageEnhancement(simulation::World& world, Topics& topics, const Profile& profile)
    : ManagedNode(world, topics, Member::kImageEnhancement, profile, {}, idle(profile)),
      pictures_(*this, topics.rgb_enhanced),
      camera_(*this, topics.rgb_camera, [this](Frame frame) {
        frame.brightness *= 1 + 2 * get<double>("image_degradation");
        pictures_.publish(frame);
      }) {
  declare("image_degradation", 1.5);
}

}  // namespace culprit::sunset::model
