#include "simulation/topic.h"

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

void TopicBase::show(Time departure) {
  if (!is_watched_ || world_.watcher() == nullptr) return;
  if (const auto at = arrival(departure, last_shown_)) {
    world_.at(*at, [this] {
      if (Watcher* watcher = world_.watcher()) watcher->on_sample(*this);
    });
  }
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
  if (Watcher* watcher = node_.world().watcher())
    watcher->on_endpoint(node_, kind_, name_, is_reported_);
}

void Endpoint::rename(std::string name) {
  Watcher* watcher = node_.world().watcher();
  if (is_reported_ && watcher) watcher->on_endpoint(node_, kind_, name_, false);
  name_ = std::move(name);
  if (is_reported_ && watcher) watcher->on_endpoint(node_, kind_, name_, true);
}

}  // namespace culprit::simulation
