// Names -> entries of the rule set under construction.
//
// Declared names come first; then every other name is looked up on the robot (design: "Names that a
// file does not declare"), so looking up creates an entry. Strict checking refuses those, and a
// name that is nearly a declared one is reported in any case: most often it is a slip.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "language/diagnostic.h"
#include "language/owner_clauses.h"
#include "language/place_index.h"
#include "language/rule_set.h"
#include "language/syntax.h"
#include "language/type_classes.h"

namespace culprit {

enum class Strictness : std::uint8_t { kLenient, kStrict };

class Symbols {
 public:
  // At most this many comparisons of names to suggest the one that was meant. A file that needs
  // more has thousands of undeclared names, which are no slips.
  static constexpr std::size_t kMaxComparisons = 200'000;

  Symbols(RuleSet& rules, Strictness strictness, std::vector<Diagnostic>& diagnostics)
      : rules_(rules),
        strictness_(strictness),
        diagnostics_(diagnostics),
        owners_(rules, diagnostics) {}

  // Enters what the file declares. Duplicates are reported; the first one counts.
  void declare(const syntax::File& file);

  // The meaning of a bare name in an expression.
  struct Constant {
    syntax::Literal value;
    bool broken = false;  // it was reported; what uses it stays silent
  };

  const Constant* constant(const std::string& name) const;
  void define_constant(const syntax::Name& name, Constant value);

  ComponentId component(const syntax::Name& name);
  // The group that start_group is for; nothing: it was reported.
  std::optional<GroupId> group(const syntax::Name& name);
  SignalId signal(const syntax::Name& name);
  // A signal that the file uses and does not declare, in a lenient check; a strict one has said so.
  bool is_looked_up(const std::string& signal) const;
  // Whether the rules read a topic of this name.
  bool is_topic(std::string_view name) const;
  // The topic that the declared signal `name` reads; empty: none.
  std::string topic_of_signal(std::string_view name) const;
  TopicId topic(const std::string& name, std::optional<ComponentId> publisher = std::nullopt);
  DiagnosticId diagnostic(const std::string& name);
  ParameterId parameter(ComponentId component, const std::string& name);
  InputId input(const Input& wanted);

  bool is_declared_component(std::string_view name) const;
  // Those that the file declares or named until now.
  std::optional<ComponentId> known_component(std::string_view name) const;
  std::optional<SignalId> known_signal(std::string_view name) const;

  // If `signal` was reported as a near miss of a declared name: takes that report back, since its
  // caller has a better one, and gives the declared name. Otherwise empty.
  std::string forget_near_miss(const std::string& signal);
  // Drops the reports that were taken back. To be called once, when all names were looked up.
  void drop_forgotten_reports();

  // Types of signals and parameters are found by use; nothing until then.
  TypeClasses& types() { return types_; }
  TypeClasses::Variable type_variable(SignalId id) const { return signal_types_[id.index]; }
  TypeClasses::Variable type_variable(ParameterId id) const { return parameter_types_[id.index]; }
  std::optional<Type> type_of(SignalId id) const { return types_.type_of(type_variable(id)); }
  std::optional<Type> type_of(ParameterId id) const { return types_.type_of(type_variable(id)); }

 private:
  void declare_broken(const syntax::BrokenDeclaration& broken);
  bool first_declaration(const syntax::Name& name, const char* what);
  void declare_component(const syntax::Component& component);
  bool declare_node(const syntax::Name& node, const Component& component);
  void check_field(const syntax::Name& field);
  void declare_signal(const syntax::Signal& signal);
  void declare_group(const syntax::Group& group);
  std::optional<ComponentId> declared_part(const syntax::Name& name, const std::string& what);
  void report_undeclared(const syntax::Name& name, const char* what,
                         const std::vector<std::string_view>& declared);
  const std::vector<std::string_view>& sorted_values();
  std::string near_name(const std::string& name, const std::vector<std::string_view>& declared);
  std::optional<ParameterId> known_parameter(ComponentId component, std::string_view name) const;
  bool is_group(std::string_view name) const;
  ComponentId group_as_component(const syntax::Name& name);
  ComponentId add_component(Component component);
  SignalId add_signal(Signal signal, std::optional<Type> type = std::nullopt);

  RuleSet& rules_;
  Strictness strictness_;
  std::vector<Diagnostic>& diagnostics_;
  OwnerClauses owners_;
  std::unordered_map<std::string, Constant> constants_;
  std::set<std::string> broken_signals_;  // and groups
  // Indexes into the tables of rules_.
  PlaceIndex components_, signals_, topics_, level_names_;  // by name
  PlaceIndex components_by_node_;                           // of those that are declared, the first
  PlaceIndex parameters_;                                   // by component and name
  PlaceIndex inputs_;                                       // by all but type and use
  // Candidates for misspelt names; views into the tree and the keys above.
  std::vector<std::string_view> declared_components_;
  std::vector<std::string_view> declared_values_;  // constants and signals
  bool are_values_sorted_ = false;                 // they are once somebody asks
  std::size_t comparisons_left_ = kMaxComparisons;
  struct NearMiss {
    std::string near;
    std::size_t report = 0;  // index into diagnostics_
  };
  std::unordered_map<std::string, NearMiss> near_misses_;
  std::set<std::size_t> forgotten_reports_;
  TypeClasses types_;
  std::vector<TypeClasses::Variable> signal_types_;
  std::vector<TypeClasses::Variable> parameter_types_;
};

}  // namespace culprit
