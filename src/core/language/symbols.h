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
      : rules_(rules), strictness_(strictness), diagnostics_(diagnostics) {}

  // Enters what the file declares. Duplicates are reported; the first one counts.
  void declare(const syntax::File& file);

  // The meaning of a bare name in an expression.
  struct Constant {
    syntax::Literal value;
    bool broken = false;  // it was reported; what uses it stays silent
  };

  // The look-ups of a rule, with their answers. As long as the answers are the same, so are the
  // diagnostics of the rule. The ids may be others by then: `was` is the one before.
  struct Uses {
    struct OfConstant {
      std::string name;
      std::optional<Constant> answer;  // empty: it is none
    };
    struct OfComponent {
      syntax::Name name;
      ComponentId id, was;
      struct Traits {
        std::string name;
        bool can_start = false;
        bool can_start_again = false;
        bool is_required = false;
        bool operator==(const Traits&) const = default;
      };
      Traits traits;
    };
    struct OfSignal {
      std::string name;
      SignalId id, was;
      struct Traits {
        std::optional<Signal::Range> range;
        std::optional<Type> type;
        bool operator==(const Traits&) const = default;
      };
      Traits traits;
    };
    struct OfTopic {
      std::string name;
      std::optional<ComponentId> publisher;
      TopicId id, was;
    };
    struct OfDiagnostic {
      std::string name;
      DiagnosticId id, was;
    };
    struct OfParameter {
      ComponentId component;
      std::string name;
      ParameterId id, was;
      std::optional<Type> type;
    };
    struct OfInput {
      Input input;
      InputId id, was;
    };
    std::vector<OfConstant> constants;
    std::vector<std::pair<std::string, bool>> looked_up;  // signals, and whether they are
    std::vector<OfComponent> components;
    std::vector<OfSignal> signals;
    std::vector<OfTopic> topics;
    std::vector<OfDiagnostic> diagnostics;
    std::vector<OfParameter> parameters;
    std::vector<OfInput> inputs;
    // A diagnostic was reported or withdrawn during a look-up: the next look-up may give another
    // answer.
    bool has_report = false;

    std::size_t size() const;
    // The id that stands for the same thing now. @pre it is one of those.
    ComponentId now(ComponentId id) const;
    TopicId now(TopicId id) const;
    SignalId now(SignalId id) const;
    ParameterId now(ParameterId id) const;
    DiagnosticId now(DiagnosticId id) const;
    InputId now(InputId id) const;
  };
  // From now on enters into `uses` what is asked; null: no more.
  void record(Uses* uses) { uses_ = uses; }
  // Whether all that was asked would be answered as it was.
  bool answers_the_same(const Uses& uses) const;
  // Asks for all that once more, `moved_by` bytes further on, and enters the ids of now.
  // @pre answers_the_same(uses)
  void ask_again(Uses& uses, std::uint32_t moved_by);

  const Constant* constant(const std::string& name);
  void define_constant(const syntax::Name& name, Constant value);

  ComponentId component(const syntax::Name& name);
  // The group that start_group is for; nothing: it was reported.
  std::optional<GroupId> group(const syntax::Name& name);
  SignalId signal(const syntax::Name& name);
  // A signal that the file uses and does not declare, in a lenient check; a strict one has said so.
  bool is_looked_up(const std::string& signal);
  TopicId topic(const std::string& name, std::optional<ComponentId> publisher = std::nullopt);
  DiagnosticId diagnostic(const std::string& name);
  ParameterId parameter(ComponentId component, const std::string& name);
  InputId input(const Input& wanted);

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
  const Component* other_of_owner(std::string owner);
  const Component* other_of_launch(const std::vector<std::string>& command);
  void declare_launch(const syntax::Component& written, Component& component);
  std::string declared_host(const syntax::Component& written);
  void declare_engine(const syntax::Component& written, Component& component);
  void declare_composition(const syntax::Component& written, Component& component);
  SystemdUnit declared_unit(const syntax::Component& written);
  void check_field(const syntax::Name& field);
  void declare_signal(const syntax::Signal& signal);
  void declare_group(const syntax::Group& group);
  std::optional<ComponentId> declared_part(const syntax::Name& name, const std::string& what);
  void report_undeclared(const syntax::Name& name, const char* what,
                         const std::vector<std::string_view>& declared);
  const std::vector<std::string_view>& sorted_values();
  std::string near_name(const std::string& name, const std::vector<std::string_view>& declared);
  bool looks_up(const std::string& signal) const;
  std::optional<ComponentId> known_component(std::string_view name) const;
  std::optional<SignalId> known_signal(std::string_view name) const;
  std::optional<ParameterId> known_parameter(ComponentId component, std::string_view name) const;
  ComponentId add_component(Component component);
  SignalId add_signal(Signal signal, std::optional<Type> type = std::nullopt);
  ComponentId known_or_new_component(const syntax::Name& name);
  Uses::OfComponent::Traits traits_of(ComponentId id) const;
  Uses::OfSignal::Traits traits_of(SignalId id) const;

  RuleSet& rules_;
  Strictness strictness_;
  std::vector<Diagnostic>& diagnostics_;
  std::unordered_map<std::string, Constant> constants_;
  std::set<std::string> broken_signals_;  // and groups
  // Indexes into the tables of rules_.
  PlaceIndex components_, signals_, topics_, level_names_;  // by name
  PlaceIndex components_by_node_;                           // of those that are declared, the first
  PlaceIndex components_by_launch_;                         // likewise
  PlaceIndex parameters_;                                   // by component and name
  PlaceIndex inputs_;                                       // by all but type and use
  std::unordered_map<std::string, ComponentId> by_owner_;   // a unit or a container
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
  Uses* uses_ = nullptr;  // what is asked goes in here
};

}  // namespace culprit
