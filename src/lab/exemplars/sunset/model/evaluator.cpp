#include "exemplars/sunset/model/evaluator.h"

#include "exemplars/sunset/health_watch.h"
#include "exemplars/sunset/model/entropy.h"

namespace culprit::sunset::model {
namespace {

using simulation::Use;

}  // namespace

Evaluator::Evaluator(simulation::World& world, Topics& topics, const simulation::Node& camera)
    : Node(world, sunset::node_of(Member::kEvaluator).full(), {}),
      downtime_(world.now(), kTolerated),
      last_output_(world.now()),
      camera_(camera),
      truths_(
          *this, topics.truth,
          [this](const Frame& frame) {
            buffer_.add_truth(frame);
            judge();
          },
          Use::kAlways),
      predictions_(
          *this, topics.segmentation,
          [this](const Frame& frame) {
            buffer_.add_prediction(frame);
            judge();
          },
          Use::kAlways) {}

void Evaluator::restart() {
  downtime_ = Downtime(world().now(), kTolerated);
  last_output_ = world().now();
  last_unwell_.reset();
}

void Evaluator::judge() {
  const auto pair = buffer_.take_pair();
  if (!pair) return;
  const Time now = world().now();
  const bool is_late = now - last_output_ > kTolerated;
  const bool is_unsure = entropy_level(pair->prediction).mean > kEntropyLimit;
  const bool is_blurred = *camera_.parameter("autofocus_needed") == Value(true);
  if (is_late || is_unsure || is_blurred) last_unwell_ = now;
  last_output_ = now;
  downtime_.on_output(now);
}

std::optional<Time> Evaluator::last_unwell() const {
  const Time now = world().now();
  return now - last_output_ > kTolerated ? now : last_unwell_;
}

bool Evaluator::is_well() const {
  const auto last = last_unwell();
  return !last || world().now() - *last >= kCalm;
}

}  // namespace culprit::sunset::model
