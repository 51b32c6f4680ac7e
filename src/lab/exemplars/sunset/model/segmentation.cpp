#include "exemplars/sunset/model/segmentation.h"

namespace culprit::sunset::model {
namespace {

simulation::NodeTraits segmenting_traits(const Profile& profile) {
  simulation::NodeTraits traits = processing_traits(profile);
  traits.configure += profile.model_loading;
  return traits;
}

}  // namespace

Segmentation::Segmentation(simulation::World& world, Topics& topics, const Profile& profile)
    : ManagedNode(world, topics, Member::kSegmentation, profile,
                  {{"gpu_failure"}, {"cuda_out_of_memory"}}, segmenting_traits(profile)),
      entropy_(world.random("entropy")),
      segmented_(*this, topics.segmentation),
      fused_(*this, topics.sensors_fused, [this](const Frame& frame) { on_frame(frame); }) {
  declare("cuda_out_of_memory", false);
  declare("gpu_failure", false);
}

void Segmentation::on_frame(const Frame& frame) {
  if (is_set("cuda_out_of_memory") || is_set("gpu_failure")) return;
  occupy(profile().inference);
  report("entropy", entropy_.of(frame));
  segmented_.publish(frame);
}

}  // namespace culprit::sunset::model
