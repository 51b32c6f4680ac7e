// The current state on the robot of a name in a rule file.
#pragma once

#include <string>

#include "language/live_inventory.h"
#include "lsp/document.h"

namespace culprit::lsp {

// In Markdown; empty if the robot says nothing about it.
std::string live_facts(const Document& document, const Occurrence& thing,
                       const LiveInventory& robot);

}  // namespace culprit::lsp
