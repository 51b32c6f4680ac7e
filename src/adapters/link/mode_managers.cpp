#include "link/mode_managers.h"

namespace culprit::link {

void ModeManagers::represents(const std::string& manager, const std::string& system) {
  systems_[manager].push_back(system);
}

void ModeManagers::node_joined(const std::string& node) {
  for (auto& [manager, systems] : systems_) std::erase(systems, node);
}

void ModeManagers::node_left(const std::string& node) {
  std::erase_if(by_system_, [&](const auto& each) { return each.second == node; });
}

std::vector<std::string> ModeManagers::systems_gone_with(const std::string& manager) {
  auto managed = systems_.extract(manager);
  return managed ? std::move(managed.mapped()) : std::vector<std::string>();
}

// The first one that offers them, for anybody may; and one that is proven to be here takes the place of one that is not.
bool ModeManagers::may_tell(const std::string& manager, const std::string& system,
                            const ros2::Graph& graph) {
  const auto [known, is_new] = by_system_.try_emplace(system, manager);
  if (is_new || known->second == manager) return true;
  const bool is_better = graph.process_of(manager) != 0 && graph.process_of(known->second) == 0;
  constexpr std::size_t kMost = 100;
  if (told_of_.size() < kMost && told_of_.emplace(system, manager).second)
    inbox_.put(LinkTrouble{"the modes of " + system + " are offered by " + known->second +
                           " and by " + manager + ": only those of " +
                           (is_better ? manager : known->second) + " count"});
  if (is_better) known->second = manager;
  return is_better;
}

}  // namespace culprit::link
