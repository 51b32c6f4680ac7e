#include "exemplars/sunset/model/sensor_fusion.h"

namespace culprit::sunset::model {
namespace {

constexpr Duration kTolerance = std::chrono::milliseconds(10);  // delta_t_threshold

bool is_enhanced(std::string_view topic) { return topic.ends_with("rgb_enhanced"); }

}  // namespace

SensorFusion::SensorFusion(simulation::World& world, Topics& topics, const Profile& profile)
    : ManagedNode(world, topics, Member::kSensorFusion, profile,
                  {{"memory_leakage"}, {"sync_issue"}}, processing_traits(profile)),
      topics_(topics),
      buffer_(profile.fusion_keeps),
      fused_(*this, topics.sensors_fused),
      rgb_(*this, topics.rgb_camera,
           [this](const Frame& frame) {
             buffer_.add_rgb(frame);
             on_arrival();
           }),
      depth_(*this, topics.depth_camera, [this](const Frame& frame) {
        buffer_.add_depth(frame);
        on_arrival();
      }) {
  declare("topic_camera_input", std::string("rgb_camera"));
  declare("image_shift", std::int64_t{0});
  for (const char* flag : {"do_recalibration", "sync_issue", "memory_leakage"})
    declare(flag, false);
}

void SensorFusion::on_start() {
  ManagedNode::on_start();
  buffer_ = BasicFusionBuffer<Frame>(profile().fusion_keeps);
  take_rgb_from(get<std::string>("topic_camera_input"));
}

bool SensorFusion::on_set(const std::string& name, const Value& value) {
  if (name == "topic_camera_input") {
    const auto& topic = std::get<std::string>(value);
    if (!is_enhanced(topic) && !topic.ends_with("rgb_camera")) return false;
    take_rgb_from(topic);
  }
  return ManagedNode::on_set(name, value);
}

void SensorFusion::take_rgb_from(std::string_view topic) {
  rgb_.read(is_enhanced(topic) ? topics_.rgb_enhanced : topics_.rgb_camera);
}

void SensorFusion::on_arrival() {
  if (const auto pair = buffer_.take_pair(kTolerance)) fuse(pair->rgb, pair->depth);
}

void SensorFusion::fuse(const Frame& rgb, const Frame& depth) {
  if (is_set("sync_issue") || is_set("memory_leakage")) return;
  if (is_set("do_recalibration")) {
    assign("image_shift", std::int64_t{0});
    assign("do_recalibration", false);
  }
  Frame fused = rgb;
  fused.shift = static_cast<int>(get<std::int64_t>("image_shift"));
  fused.noise = depth.noise;
  fused_.publish(fused);
}

}  // namespace culprit::sunset::model
