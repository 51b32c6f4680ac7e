#include "simulation/world.h"

namespace culprit::simulation {

// FNV-1a of the name, mixed with the seed.
Random World::random(std::string_view name) const {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return Random(mix(seed_) ^ hash);
}

bool World::step(Time until) {
  const Time next = agenda_.next();
  if (next == kNever || next > until) return false;
  now_ = next;
  agenda_.take()();
  return true;
}

void World::run(Time until) {
  while (step(until)) continue;
  set_time(until);
}

Node* World::node(std::string_view name) const {
  const auto found = nodes_by_name_.find(name);
  return found == nodes_by_name_.end() ? nullptr : found->second;
}

TopicBase* World::topic(std::string_view name) const {
  const auto found = topics_.find(name);
  return found == topics_.end() ? nullptr : found->second;
}

ModeManager* World::modes_of(std::string_view system) const {
  const auto found = systems_.find(system);
  return found == systems_.end() ? nullptr : found->second;
}

}  // namespace culprit::simulation
