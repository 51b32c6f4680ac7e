// What a thing of a rule file is on the robot now.
#pragma once

#include <string>

#include "language/live_inventory.h"
#include "lsp/document.h"

namespace culprit::lsp {

// In Markdown; empty if the robot says nothing about it.
std::string live_facts(const Document& document, const Occurrence& thing,
                       const LiveInventory& robot);

}  // namespace culprit::lsp
