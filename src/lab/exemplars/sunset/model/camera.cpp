#include "exemplars/sunset/model/camera.h"

namespace culprit::sunset::model {
namespace {

simulation::NodeTraits sensor(const Profile& profile, Duration configure) {
  simulation::NodeTraits traits;
  traits.start = profile.start;
  traits.configure = configure;
  traits.activation_delay = profile.sensor_activation;
  traits.end = profile.end;
  return traits;
}

}  // namespace

Camera::Camera(simulation::World& world, Topics& topics, const Profile& profile)
    : ManagedNode(world, topics, Member::kCamera, profile,
                  {{"hardware_disconnect"}, {"camera_driver_issue"}},
                  sensor(profile, profile.configure)),
      pictures_(*this, topics.rgb_camera),
      raw_(*this, topics.rgb_raw, [this](const Frame& frame) { on_frame(frame); }) {
  declare("image_degradation", 0.0);
  for (const char* flag :
       {"camera_driver_issue", "hardware_disconnect", "autofocus_needed", "perform_autofocus"})
    declare(flag, false);
}

void Camera::on_activate() {
  ManagedNode::on_activate();
  if (profile().activation_restores_brightness) assign("image_degradation", 0.0);
}

void Camera::on_frame(Frame frame) {
  if (is_set("autofocus_needed")) {
    occupy(profile().focusing);
    report("autofocus_needed", true);
  }
  if (is_set("perform_autofocus")) {
    report("autofocus_needed", false);
    assign("autofocus_needed", false);
    assign("perform_autofocus", false);
  }
  if (is_set("camera_driver_issue") || is_set("hardware_disconnect")) return;
  frame.brightness *= 1 - 0.5 * get<double>("image_degradation");
  pictures_.publish(frame);
}

DepthCamera::DepthCamera(simulation::World& world, Topics& topics, const Profile& profile)
    : ManagedNode(world, topics, Member::kDepth, profile, {}, sensor(profile, {})),
      pictures_(*this, topics.depth_camera),
      raw_(*this, topics.depth_raw, [this](const Frame& frame) { on_frame(frame); }) {
  declare("depth_degradation", 0.0);
}

void DepthCamera::on_frame(Frame frame) {
  frame.noise = get<double>("depth_degradation");
  pictures_.publish(frame);
}

}  // namespace culprit::sunset::model
