#include "init/running_launch.h"

#include <chrono>
#include <set>

#include "owners/launch_file.h"
#include "owners/proc.h"

namespace culprit::init {

using namespace std::chrono_literals;

RunningLaunch running_launch(const LiveInventory& robot) {
  constexpr Duration kLimit = 20s;
  RunningLaunch found;
  std::set<int> launchers;
  for (const auto& [name, node] : robot.nodes) {
    if (node.pid == 0 || !robot.services.contains(name + "/_container/load_node")) continue;
    const owners::Origin origin = owners::origin_of(node.pid);
    if (origin.what != owners::Origin::What::kKnown || !launchers.insert(origin.pid).second)
      continue;
    const auto text = owners::composed_nodes_of_launch(origin.pid, kLimit);
    auto dump = text ? read_launch_dump(*text, "the launch file")
                     : Expected<LaunchDump>(Error{text.error()});
    if (!dump) {
      found.notes.push_back(name +
                            ": how its components were loaded is not known: " + dump.error());
      continue;
    }
    found.dump.recipes.merge(dump->recipes);
    found.dump.is_of_running = true;
  }
  return found;
}

}  // namespace culprit::init
