// The tables of a fleet's database, in the schema `culprit`, and the rights of each role there
// (docs/fleet.md).
//
// Two roles without a login, which logins are members of: culprit_robot adds and reads its own rows
// (row-level security goes by the login), and reads the sums of all; culprit_reader reads all.
#pragma once

#include <string>
#include <vector>

#include "fleet/postgres.h"

namespace culprit::fleet {

// The version of the databases that this culprit can use.
int schema_version();

// The changes that were made, one line each.
using Done = std::vector<std::string>;

struct Setup {
  int keep_days = 400;  // how long failures are kept
};

// Makes the schema and the roles, or brings them up to date; makes partitions for the months that
// come, and drops those that are over. May be repeated. Errors: the database is of a newer culprit,
// or the login may not do so.
Expected<Done> set_up(Postgres& server, const Setup& setup);

// Whether it is a database that this culprit can speak with. Errors say what to do.
Expected<void> check_schema(Postgres& server);

}  // namespace culprit::fleet
