#include "simulation/topic.h"

#include <algorithm>

namespace culprit::simulation {

TopicBase::TopicBase(World& world, std::string name, Transport transport)
    : world_(world), name_(std::move(name)), transport_(transport), random_(world.random(name_)) {
  world_.topics_.emplace(name_, this);
}

TopicBase::~TopicBase() { world_.topics_.erase(name_); }

std::optional<Time> TopicBase::arrival(Time departure, Time& last) {
  if (transport_.loss > 0 && random_.chance(transport_.loss)) return std::nullopt;
  last = std::max(last, later(departure, transport_.latency.draw(random_)));
  return last;
}

void TopicBase::watch_field(const std::string& field) {
  if (std::find(fields_.begin(), fields_.end(), field) == fields_.end()) fields_.push_back(field);
}

void TopicBase::show(Time departure, Fields fields) {
  const auto at = arrival(departure, last_shown_);
  if (!at) return;
  world_.at(*at, [this, fields = std::move(fields)] {
    world_.show([&](Watcher& watcher) {
      watcher.on_sample(*this);
      for (const auto& [field, value] : fields) watcher.on_field(*this, field, value);
    });
  });
}

Endpoint::Endpoint(Node& node, EndpointKind kind, std::string name, Use use)
    : node_(node), kind_(kind), name_(std::move(name)), use_(use) {
  node_.endpoints_.push_back(this);
}

Endpoint::~Endpoint() { std::erase(node_.endpoints_, this); }

bool Endpoint::is_open() const {
  return node_.process() != ProcessState::kGone && node_.is_in_graph() &&
         (use_ == Use::kAlways || node_.is_active());
}

void Endpoint::report() {
  if (std::exchange(is_reported_, is_open()) == is_open()) return;
  if (!is_reported_) forget();
  show(is_reported_);
}

void Endpoint::show(bool is_there) const {
  node_.world().show([&](Watcher& watcher) { watcher.on_endpoint(node_, kind_, name_, is_there); });
}

void Endpoint::rename(std::string name) {
  if (is_reported_) show(false);
  name_ = std::move(name);
  if (is_reported_) show(true);
}

}  // namespace culprit::simulation
