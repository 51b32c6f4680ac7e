// A first rule file for a robot, from what was seen of it while it was well.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "init/part.h"
#include "init/robot_profile.h"

namespace culprit::init {

enum class Packs : std::uint8_t { kNone, kChosen };

// Names that are there already, of a file that is brought up to a robot.
struct KnownNames {
  std::map<std::string, std::string> components;  // by node
  std::set<std::string> taken;                    // for something else, too
};

// For each node whose process can be started again, a component and a rule that it runs and its topics are published, or with kChosen the pack that monitors
// these. Then other rules and proposals; at the end the omissions, with the reasons. Guesses are marked "# guess:".
std::vector<Part> parts_of_draft(const RobotProfile& seen, Packs packs,
                                 const KnownNames& known = {});

// These together: the text of a rule file that `culprit check --robot --strict` finds nothing in. Ends in the
// marks by which update() knows what was drafted (marks.h).
std::string draft(const RobotProfile& seen, Packs packs = Packs::kNone);

// The file of parameters that the draft names, as --params-file takes it, with a mark (marks.h); empty: it
// names none. `before`: the file that is there, as culprit wrote it: what it has of nodes of which the dump says nothing now
// stays, for these may only be ill.
std::string parameters_text(const RobotProfile& seen, const std::string& before = "");

}  // namespace culprit::init
