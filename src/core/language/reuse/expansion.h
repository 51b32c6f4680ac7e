// INCLUDE, TEMPLATE and USE -> the plain rules that they stand for.
//
//     Expansion rules = expand(source, load);
//     const Checked checked = check(rules);
//     for (const Diagnostic& d : checked.diagnostics) show(render(d, rules.source));
//
// The result is one text like any that a person wrote by hand: it is checked, managed by and kept
// in the journal. It knows where each of its parts was written (Source::origin), so diagnostics
// point there. INCLUDE and USE lines stay in it as comments.
//   - A file is there once, however often it is included. Templates may be used before they are
//     read, and by other templates.
//   - A name that a template declares is one of the rules, as it is written there, with the
//     arguments put in. Its constants are its own: one of a name that is taken gets another.
//   - A COMPONENT of a template gives way to another one that is the same node.
//   - IN puts all full names of topics, services and nodes below a namespace, and the namespace in
//     front of the names that are declared. /clock, /diagnostics, /parameter_events and /rosout
//     belong to no robot, and names in quoted texts are not looked into.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "language/diagnostic.h"
#include "language/source.h"

namespace culprit {

// The file that `file` means in an INCLUDE of the file that is called `from`. Errors: there is none;
// the message is one line. Files of one name are one file.
using RuleLoader =
    std::function<Expected<Source>(const std::string& file, const std::string& from)>;

// A template that USE can name.
struct KnownTemplate {
  std::string usage;  // "driver(name, topic, hz = 10)"
  Place name;         // where it stands
};

struct Expansion {
  Source source{"", ""};
  // Errors of which the rules cannot be put together; if there are any, `source` is what they are
  // about, and no rules.
  std::vector<Diagnostic> mistakes;
  std::map<std::string, KnownTemplate> templates{};  // of all files, by name
};

// A source without one of these statements comes back as it is. Without a loader nothing can be
// included.
Expansion expand(Source source, const RuleLoader& load = nullptr);

// Whether a line begins with INCLUDE, TEMPLATE or USE.
bool has_reuse(const Source& source);

}  // namespace culprit
