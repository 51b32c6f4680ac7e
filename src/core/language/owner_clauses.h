// The clauses of a COMPONENT line that say who starts it, and how -> Component.
//
//     LAUNCH, with ENV, SETUP, CWD    culprit itself
//     UNIT, CONTAINER, with HOST      systemd or a container engine, here or over ssh
//     IN, with PLUGIN, PACKAGE,       a component container
//         PARAMETERS, REMAP
//
// One program starts a component, and an owner starts one component: contradictions are reported.
// Symbols enters the names and the nodes.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "language/diagnostic.h"
#include "language/place_index.h"
#include "language/rule_set.h"
#include "language/syntax.h"

namespace culprit {

class OwnerClauses {
 public:
  // Both must outlive it.
  OwnerClauses(const RuleSet& rules, std::vector<Diagnostic>& diagnostics)
      : rules_(rules), diagnostics_(diagnostics) {}

  // For so many components.
  void reserve(std::size_t components) { components_by_launch_.reserve(components); }

  // Fills in `component`, which is the next one to be entered in the rules.
  void read(const syntax::Component& written, Component& component);

 private:
  const Component* other_of_owner(std::string owner);
  const Component* other_of_launch(const std::vector<std::string>& command);
  void launch(const syntax::Component& written, Component& component);
  std::string whole_path(const syntax::Name& path);
  std::string host(const syntax::Component& written);
  SystemdUnit unit(const syntax::Component& written);
  void engine(const syntax::Component& written, Component& component);
  void composition(const syntax::Component& written, Component& component);
  void check_without_container(const syntax::Component& written);
  void plugin(const syntax::Component& written, Composition& composed);
  void remaps(const syntax::Name& written, Composition& composed);
  void report(const syntax::Name& where, std::string cause, std::string remedy,
              Code code = Code::kSyntax);

  const RuleSet& rules_;
  std::vector<Diagnostic>& diagnostics_;
  PlaceIndex components_by_launch_;                        // of those that are declared, the first
  std::unordered_map<std::string, ComponentId> by_owner_;  // a unit or a container
};

}  // namespace culprit
