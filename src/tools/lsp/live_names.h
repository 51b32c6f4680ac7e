// The robot's own names, proposed where they fit.
#pragma once

#include <string>
#include <vector>

#include "language/live_inventory.h"
#include "lsp/completion.h"

namespace culprit::lsp {

std::vector<Proposal> live_nodes(const LiveInventory& robot);
std::vector<Proposal> live_topics(const LiveInventory& robot);
// The parameters of the node that `component` names.
std::vector<Proposal> live_parameters(const LiveInventory& robot, const Component& component);
// Services that can be called, with their types.
std::vector<Proposal> live_routines(const LiveInventory& robot);
std::vector<Proposal> live_statuses(const LiveInventory& robot);
// The keys of the statuses of this name or hardware id.
std::vector<Proposal> live_keys(const LiveInventory& robot, const std::string& status);

}  // namespace culprit::lsp
