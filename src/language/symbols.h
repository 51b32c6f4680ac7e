// Names -> entries of the rule set under construction.
//
// Declared names come first; then every other name is looked up on the robot (design: "Names that a
// file does not declare"), so looking up creates an entry. Strict checking refuses those, and a
// name that is nearly a declared one is reported in any case: most often it is a slip.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "language/diagnostic.h"
#include "language/rule_set.h"
#include "language/syntax.h"
#include "language/type_classes.h"

namespace culprit {

enum class Strictness : std::uint8_t { kLenient, kStrict };

class Symbols {
 public:
  Symbols(RuleSet& rules, Strictness strictness, std::vector<Diagnostic>& diagnostics)
      : rules_(rules), strictness_(strictness), diagnostics_(diagnostics) {}

  // Enters what the file declares. Duplicates are reported; the first one counts.
  void declare(const syntax::File& file);

  // What a bare name in an expression means.
  struct Constant {
    syntax::Literal value;
    bool broken = false;  // it was reported; what uses it stays silent
  };
  const Constant* constant(const std::string& name) const;
  void define_constant(const syntax::Name& name, Constant value);

  ComponentId component(const syntax::Name& name);
  SignalId signal(const syntax::Name& name);
  // A signal that the file uses and does not declare, in a lenient check; a strict one has said so.
  bool is_looked_up(const std::string& signal) const;
  TopicId topic(const std::string& name);
  DiagnosticId diagnostic(const std::string& name);
  ParameterId parameter(ComponentId component, const std::string& name);
  InputId input(const Input& wanted);

  // If `signal` was reported as a near miss of a declared name: takes that report back, since its
  // caller has a better one, and gives the declared name. Otherwise empty.
  std::string forget_near_miss(const std::string& signal);

  // Types of signals and parameters are found by use; nothing until then.
  TypeClasses& types() { return types_; }
  TypeClasses::Variable type_variable(SignalId id) const { return signal_types_[id.index]; }
  TypeClasses::Variable type_variable(ParameterId id) const { return parameter_types_[id.index]; }
  std::optional<Type> type_of(SignalId id) const { return types_.type_of(type_variable(id)); }
  std::optional<Type> type_of(ParameterId id) const { return types_.type_of(type_variable(id)); }

 private:
  void declare_broken(const syntax::BrokenDeclaration& broken);
  bool first_declaration(const syntax::Name& name, const char* what);
  void report_undeclared(const syntax::Name& name, const char* what,
                         const std::vector<std::string_view>& declared);

  RuleSet& rules_;
  Strictness strictness_;
  std::vector<Diagnostic>& diagnostics_;
  std::set<std::string, std::less<>> declared_;
  std::unordered_map<std::string, Constant> constants_;
  std::unordered_map<std::string, ComponentId> components_;
  std::unordered_map<std::string, SignalId> signals_;
  std::unordered_map<std::string, TopicId> topics_;
  std::unordered_map<std::string, DiagnosticId> level_names_;
  std::map<std::pair<ComponentId, std::string>, ParameterId> parameters_;
  std::unordered_map<std::string, InputId> inputs_;
  struct NearMiss {
    std::string near;
    Span span;
  };
  std::unordered_map<std::string, NearMiss> near_misses_;
  TypeClasses types_;
  std::vector<TypeClasses::Variable> signal_types_;
  std::vector<TypeClasses::Variable> parameter_types_;
};

}  // namespace culprit
