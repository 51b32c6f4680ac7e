#include "owners/found_owner.h"

#include <fstream>

#include "owners/proc.h"

namespace culprit::owners {

std::optional<FoundOwner> found_owner(int pid, const std::string& loader) {
  if (pid == 0) return std::nullopt;
  if (!loader.empty())
    return FoundOwner{"the component container " + loader,
                      "IN " + loader + " PLUGIN package::Class"};
  if (const std::string id = container_of(pid); !id.empty()) {
    constexpr std::size_t kShown = 12;  // as the engines' tools show it
    return FoundOwner{"a container engine in " + id.substr(0, kShown),
                      "CONTAINER, with the engine and the container's name"};
  }
  if (const auto unit = unit_started_as(pid))
    return FoundOwner{"systemd as " + unit->name,
                      "UNIT " + unit->name + (unit->is_of_user ? " USER" : "")};
  const Origin origin = origin_of(pid);
  if (origin.what != Origin::What::kKnown) return std::nullopt;
  const int parent = origin.pid;
  std::string command;
  std::getline(std::ifstream("/proc/" + std::to_string(parent) + "/comm") >> std::ws, command);
  for (char& c : command) {
    if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > '~') c = '?';
  }
  return FoundOwner{"process " + std::to_string(parent) + " (" + command + ")",
                    "RESPAWNED if that starts it again, else LAUNCH"};
}

}  // namespace culprit::owners
