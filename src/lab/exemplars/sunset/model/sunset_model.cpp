#include "exemplars/sunset/model/sunset_model.h"

#include <algorithm>

#include "simulation/fault.h"

namespace culprit::sunset::model {
namespace {

constexpr Duration kWatchedBefore = std::chrono::seconds(1);

}  // namespace

SunsetModel::SunsetModel(const Profile& profile, std::uint64_t seed)
    : profile_(profile),
      world_(seed),
      random_(world_.random("experiment")),
      topics_(world_),
      bag_(world_, sunset::node_of(Member::kWorld).full(), {}),
      rgb_(bag_, topics_.rgb_raw, simulation::Use::kAlways),
      depth_raw_(bag_, topics_.depth_raw, simulation::Use::kAlways),
      truth_(bag_, topics_.truth, simulation::Use::kAlways),
      camera_(world_, topics_, profile),
      depth_(world_, topics_, profile),
      enhancement_(world_, topics_, profile),
      fusion_(world_, topics_, profile),
      segmentation_(world_, topics_, profile),
      evaluator_(world_, topics_, camera_) {
  if (profile.has_blackboard) blackboard_ = std::make_unique<Blackboard>(world_, topics_, profile);
  for (simulation::Node* node : world_.nodes()) node->launch();
  world_.after({}, [this] { play_frame(); });
}

void SunsetModel::play_frame() {
  const Frame frame{stamp_};
  rgb_.publish(frame);
  depth_raw_.publish(frame);
  truth_.publish(frame);
  stamp_ += kFramePeriod;
  world_.after(kFramePeriod, [this] { play_frame(); });
}

simulation::Node& SunsetModel::node(Member member) {
  return *world_.node(sunset::node_of(member).full());
}

std::vector<SunsetModel::Injection> SunsetModel::inject(const Scenario& scenario) {
  const Time begin{profile_.injection.draw(random_)};
  const simulation::Span race{{}, profile_.injection_jitter};
  std::vector<Injection> injections;
  for (const Fault* fault : scenario.faults) {
    const Time at = later(begin, race.draw(random_));
    const bool is_there = std::any_of(injections.begin(), injections.end(),
                                      [&](const Injection& each) { return each.fault == fault; });
    if (is_there) continue;  // named again, it would come back after its repair
    injections.push_back({at, fault});
    // The exemplar's faults are parameters that its nodes have.
    (void)simulation::inject(world_,
                             {injections.back().at, sunset::node_of(fault->member).full(),
                              simulation::BadParameter{std::string(fault->name), fault->value}});
  }
  std::sort(injections.begin(), injections.end(),
            [](const Injection& a, const Injection& b) { return a.at < b.at; });
  // A gap counts from the last picture before the fault.
  world_.at(injections.front().at - kWatchedBefore, [this] { evaluator_.restart(); });
  return injections;
}

bool SunsetModel::has(const Fault& fault) {
  const Value* value = node(fault.member).parameter(std::string(fault.name));
  return value != nullptr && *value != fault.healthy;
}

}  // namespace culprit::sunset::model
