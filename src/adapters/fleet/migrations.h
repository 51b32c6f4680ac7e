// The SQL that makes a fleet's database: one step for each version. A released step never changes.
#pragma once

#include <string>

namespace culprit::fleet {

int migration_count();

// The statements that turn version n into version n + 1. @pre 0 <= n < migration_count()
std::string migration(int n);

}  // namespace culprit::fleet
