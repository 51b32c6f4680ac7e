// Design-time checks of how components are started: ROS commands that lack a word, containers that are
// no components. Each would be found out only after the old process was ended.
#pragma once

#include <vector>

#include "language/diagnostic.h"
#include "language/rule_set.h"
#include "language/syntax.h"

namespace culprit {

// A LAUNCH of ros2 without its program or file, a launch file as a program, ROS arguments that a node
// ignores or refuses. `component` is what `written` declares.
void check_command(const syntax::Component& written, const Component& component,
                   std::vector<Diagnostic>& diagnostics);

// IN names a node that is no component, or one that a container loads itself. @pre no declaration has
// an error.
void check_containers(const syntax::File& file, const RuleSet& rules,
                      std::vector<Diagnostic>& diagnostics);

// NODE names what is a topic on each robot, as in a USE whose arguments are exchanged.
void check_topics_as_nodes(const syntax::File& file, std::vector<Diagnostic>& diagnostics);

}  // namespace culprit
