// The known robot (knowledge/known_robot.h) as JSON, and as a row.
#pragma once

#include "journal/json.h"
#include "knowledge/known_robot.h"

namespace culprit::journal {

Json to_json(const KnownRobot& known);
// Leaves out what cannot be read.
KnownRobot known_robot_from_json(const Json& json);

// Another domain is another robot, and so is another start of the machine: observations from there
// mean nothing here.
struct Whereabouts {
  int domain = 0;
  std::string boot;  // boot_id()
  bool operator==(const Whereabouts&) const = default;
};

// The body of a `robot` row.
Json robot_row(const KnownRobot& known, const Whereabouts& where);
// Empty if the row is about another robot.
KnownRobot known_robot_of(const Json& row, const Whereabouts& where);

}  // namespace culprit::journal
