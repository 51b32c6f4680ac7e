// The syntax tree: a rule file as it is written, before any name or type is looked up.
//
// Every part knows its place in the text. A part that was missing or broken in the text is left out
// or left empty. The parser has reported it, so later stages must not (one mistake, one message).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/seldom.h"
#include "base/units.h"
#include "language/source.h"

namespace culprit::syntax {

struct Name {
  std::string text;
  Span span;
};

// A constant as written. Durations are a type of their own; the rest are Values.
using Literal = std::variant<bool, std::int64_t, double, std::string, Duration>;

enum class Operator : std::uint8_t {
  kNot,
  kNegate,
  kPlus,  // the sign: +5
  kMultiply,
  kDivide,
  kRemainder,
  kAdd,
  kSubtract,
  kLess,
  kLessEqual,
  kGreater,
  kGreaterEqual,
  kEqual,
  kNotEqual,
  kAnd,
  kOr
};
std::string_view symbol(Operator op);

struct Expression {
  enum class Kind : std::uint8_t {
    kLiteral,  // *literal
    kName,   // name: a constant, a signal; as an argument also a topic, a component, a parameter, a
             // diagnostic. A topic with a FROM has its publisher as children[0]
    kUnary,  // op children[0]
    kBinary,       // children[0] op children[1]
    kConditional,  // children[0] ? children[1] : children[2]
    kCall          // name(children...)
  };
  Kind kind = Kind::kLiteral;
  Operator op = Operator::kNot;
  Span span;
  Seldom<Literal> literal{};  // there if it is a kLiteral
  Name name;
  std::vector<Expression> children;
};

struct Number {
  double value = 0;
  bool whole = false;  // written without point and exponent
  Span span;
};

struct Constant {
  Name name;
  Expression value;
};

// The driver that takes a managed node through its lifecycle when it starts.
enum class LifecycleDriver : std::uint8_t {
  kUndeclared,
  kSelf,     // the node itself: culprit waits, and never drives a start
  kManaged,  // culprit, at once
  kLauncher  // the program that starts it, or a lifecycle manager of its own: as kSelf
};

struct Component {
  Name name;
  std::optional<Name> node;
  std::optional<Name> launch;  // the quoted text, unescaped
  Seldom<Name> setup{};
  Seldom<Name> environment{};  // likewise
  Seldom<Name> folder{};
  bool is_required = false;
  bool is_respawned = false;
  std::optional<Duration> ready{};
  Seldom<Name> unit{};
  bool is_users_unit = false;
  Seldom<Name> engine{};  // "docker" or "podman"
  Seldom<Name> engine_container{};
  Seldom<Name> host{};       // the computer that runs it, as for ssh: "robot@rover2"
  Seldom<Name> container{};  // the node that loads it
  Seldom<Name> plugin{};
  Seldom<Name> package{};
  Seldom<Name> parameters{};
  Seldom<Name> remaps{};  // "a:=b c:=d"
  LifecycleDriver lifecycle = LifecycleDriver::kUndeclared;
  std::vector<Name> other_nodes{};  // of the same process
};

struct Dependency {
  Name consumer;
  std::vector<Name> producers;
};

// Components that one lifecycle manager takes through their lifecycles, in this order.
struct Group {
  Name name;
  std::vector<Name> members;
  Name manager;
};

struct DiagnosticSource {
  Name status;
  Name key;
};
struct TopicSource {
  Name topic;
  Name field;
};
struct ParameterSource {
  Name component;
  Name parameter;
};

struct Signal {
  Name name;
  std::variant<DiagnosticSource, TopicSource, ParameterSource> source;
  std::optional<Duration> stale;
  struct Range {
    double low = 0;
    double high = 0;
    Span span;
  };
  std::optional<Range> range;
  Seldom<Name> from{};  // the component that publishes it; never of a parameter
};

enum class AdaptationType : std::uint8_t {
  kSetParameter,
  kIncreaseParameter,
  kDecreaseParameter,
  kChangeCommunication,
  kActivate,
  kDeactivate,
  kRestart,
  kRedeploy,
  kStart,
  kStop,
  kChangeMode,
  kCall,
  kStartGroup  // of a group, which stands in the place of the component
};
std::string_view keyword(AdaptationType type);
std::optional<AdaptationType> adaptation_type(std::string_view keyword);
std::vector<std::string_view> adaptation_keywords();
// Whether its subject is a parameter.
bool names_parameter(AdaptationType type);

struct Adaptation {
  Name component;
  AdaptationType type = AdaptationType::kSetParameter;
  Name subject;            // parameter, mode or service; empty for types without one
  Name topic;              // change_communication
  Seldom<Name> request{};  // call: what the service is asked, as `ros2 service call` takes it
  Seldom<Expression> value;
  Number impact;
  Span span;
  bool begins_step = false;  // THEN: it begins when the one above is proven
};

struct Strategy {
  Name name;
  Number probability;
  Number confidence;
  Seldom<Expression> when;
  std::vector<Adaptation> adaptations;
  bool is_last_resort = false;
  std::optional<Duration> within{};  // LASTRESORT only
  bool has_broken_adaptation = false;
};

enum class Criticality : std::uint8_t { kNonCritical, kWarning, kError };

struct Policies {
  Criticality criticality = Criticality::kNonCritical;
  std::optional<Duration> hold_for;
  struct Hold {
    std::int64_t needed = 1;
    std::int64_t window = 1;
    Span span;
  };
  std::optional<Hold> hold;
  std::optional<Duration> cooldown;
  Span cooldown_span;  // of the word
  struct Attempts {
    std::int64_t count = 0;
    Span span;
  };
  std::optional<Attempts> attempts;
  bool on_change = false;
  bool is_report = false;  // REPORT: culprit does nothing about it, a person is notified
  Span span;
};

struct Rule {
  Name name;
  std::optional<Policies> policies;
  std::optional<Expression> trigger;
  std::vector<Strategy> strategies;
  bool has_broken_part = false;  // a POLICIES, TRIGGER or STRATEGY line is there and does not parse
};

// A condition without which nothing is done, and how it is written.
struct Interlock {
  Expression condition;
  std::string text;
};

// A DRILL line: a limit on what a drill does to a component (docs/drill.md).
struct Drill {
  enum class What : std::uint8_t {
    kSetParameter,  // also injects this value: subject, value
    kWithout,       // never injects this fault: subject
    kLimit          // breaks it so often at most: times
  };
  Name component;
  What what = What::kLimit;
  Name subject{};
  Seldom<Expression> value{};
  std::int64_t times = 0;
};
// Faults that WITHOUT may name.
std::vector<std::string_view> drill_faults();

// A line that declares something and does not parse: what uses the name is not at fault.
struct BrokenDeclaration {
  enum class Kind : std::uint8_t { kConstant, kComponent, kSignal };
  Kind kind = Kind::kConstant;
  Name name;
};

// The rules of another file are there too.
struct Include {
  Name file;
  Span span;  // of the statement
};

// The statements of a template, once, with these arguments.
struct Use {
  Name pattern;                 // which template
  std::vector<Name> arguments;  // their spans have the quotes that they may be written with
  std::optional<Name> in{};     // the namespace of every full name in it
  Span span;                    // of the statement
};

struct TemplateParameter {
  Name name;
  std::optional<Name> usual{};  // what it is where a USE gives nothing for it
};

struct Template;

struct File {
  std::optional<Name> robot;
  struct Cycle {
    Duration length{};
    Span span;
  };
  std::optional<Cycle> cycle;
  std::vector<Constant> constants;
  std::vector<Component> components;
  std::vector<Dependency> dependencies;
  std::vector<Group> groups;
  std::vector<Name> ignored_topics;
  std::vector<Interlock> interlocks;
  std::vector<Interlock> aborts;  // conditions that end a drill
  std::vector<Drill> drills;
  std::vector<Signal> signals;
  std::vector<Rule> rules;
  std::vector<BrokenDeclaration> broken_declarations;
  // The words of settings, which hold for the whole file, that stand among the lines of a rule.
  std::vector<Name> settings_in_rules;
  // Statements that expand() (reuse/expansion.h) replaces with other text.
  std::vector<Include> includes;
  std::vector<Template> templates;
  std::vector<Use> uses;

  bool has_reuse() const;
};

// Statements with parameters: in `body`, "{name}" stands for, or within, names, numbers, durations
// and texts. The values of numbers and durations with parameters are not known there.
struct Template {
  Name name;
  std::vector<TemplateParameter> parameters;
  File body;
  Span span;   // from TEMPLATE to the end of the END line, or of the text
  Span lines;  // those between TEMPLATE and END, with their line ends
};

}  // namespace culprit::syntax
