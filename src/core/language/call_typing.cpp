#include "language/call_typing.h"

#include "base/units.h"
#include "language/compiler.h"
#include "language/evaluate.h"
#include "language/functions.h"
#include "language/line_reader.h"

namespace culprit {
namespace {

using syntax::Expression;
using Kind = Expression::Kind;

class CallTyper {
 public:
  explicit CallTyper(Typer& typer) : typer_(typer), symbols_(typer.symbols()) {}

  std::optional<Typed> call(const Expression& e);

 private:
  std::optional<Typed> of_topic(const Expression& e, Input::Kind kind, Type type);
  std::optional<Typed> of_component(const Expression& e, Input::Kind kind, Type type);
  std::optional<Typed> parameter(const Expression& e);
  std::optional<Typed> level(const Expression& e);
  std::optional<Typed> changed(const Expression& e);
  std::optional<Typed> frozen(const Expression& e);
  std::optional<Typed> isnan(const Expression& e);
  std::optional<Typed> goals(const Expression& e);
  std::optional<Typed> goal_age(const Expression& e);
  std::optional<Typed> logs(const Expression& e);
  std::optional<Typed> rate(const Expression& e);
  std::optional<Typed> window(const Expression& e, Input::Kind kind);
  std::optional<Typed> extreme(const Expression& e, Op exact, Op real);
  std::optional<Typed> absolute(const Expression& e);
  std::optional<Typed> real_function(const Expression& e, Op op);

  std::optional<Duration> window_argument(const Expression& e);
  std::optional<SignalId> signal_argument(const Expression& call);
  std::optional<TopicId> topic_argument(const Expression& e);
  std::optional<TopicId> action_argument(const Expression& e);

  Typed input(const Input& wanted, Type type) { return typer_.input(wanted, type); }
  bool is_swapped(const Expression& e);
  bool is_window_first(const Expression& e);
  bool is_window(const Expression& e) const;
  std::nullopt_t window_in_brackets(const Expression& e, std::size_t bracket);

  Typer& typer_;
  Symbols& symbols_;
};

std::optional<Typed> CallTyper::call(const Expression& e) {
  switch (find_function(e.name.text)->function) {
    case Function::kRate:
      return rate(e);
    case Function::kAge:
      return of_topic(e, Input::Kind::kAge, Type::kDuration);
    case Function::kPhi:
      return of_topic(e, Input::Kind::kPhi, Type::kDouble);
    case Function::kLoss:
      return of_topic(e, Input::Kind::kLoss, Type::kDouble);
    case Function::kAlive:
      return of_component(e, Input::Kind::kAlive, Type::kBool);
    case Function::kLifecycle:
      return of_component(e, Input::Kind::kLifecycle, Type::kString);
    case Function::kCpu:
      return of_component(e, Input::Kind::kCpu, Type::kDouble);
    case Function::kMemory:
      return of_component(e, Input::Kind::kMemory, Type::kDouble);
    case Function::kParameter:
      return parameter(e);
    case Function::kLevel:
      return level(e);
    case Function::kMean:
      return window(e, Input::Kind::kMean);
    case Function::kStddev:
      return window(e, Input::Kind::kStddev);
    case Function::kChanged:
      return changed(e);
    case Function::kFrozen:
      return frozen(e);
    case Function::kIsNan:
      return isnan(e);
    case Function::kGoals:
      return goals(e);
    case Function::kGoalAge:
      return goal_age(e);
    case Function::kLogs:
      return logs(e);
    case Function::kMin:
      return is_window(e) ? window(e, Input::Kind::kMin) : extreme(e, Op::kMinInt, Op::kMinDouble);
    case Function::kMax:
      return is_window(e) ? window(e, Input::Kind::kMax) : extreme(e, Op::kMaxInt, Op::kMaxDouble);
    case Function::kAbs:
      return absolute(e);
    case Function::kPow:
      return real_function(e, Op::kPower);
    case Function::kSqrt:
      return real_function(e, Op::kSquareRoot);
  }
  return std::nullopt;
}

std::optional<Typed> CallTyper::of_topic(const Expression& e, Input::Kind kind, Type type) {
  const auto topic = topic_argument(e.children[0]);
  if (!topic) return std::nullopt;
  Input wanted;
  wanted.kind = kind;
  wanted.topic = *topic;
  return input(wanted, type);
}

std::optional<Typed> CallTyper::of_component(const Expression& e, Input::Kind kind, Type type) {
  Input wanted;
  wanted.kind = kind;
  wanted.component = symbols_.component(e.children[0].name);
  return input(wanted, type);
}

std::optional<Typed> CallTyper::parameter(const Expression& e) {
  if (is_swapped(e)) return std::nullopt;
  Input wanted;
  wanted.kind = Input::Kind::kParameter;
  wanted.component = symbols_.component(e.children[0].name);
  wanted.parameter = symbols_.parameter(wanted.component, e.children[1].name.text);
  const auto type = symbols_.type_of(wanted.parameter);
  if (!type) return typer_.unknown_type(e.children[1]);
  return input(wanted, *type);
}

std::optional<Typed> CallTyper::level(const Expression& e) {
  const syntax::Name& status = e.children[0].name;
  if (status.text == "/diagnostics" || status.text == "/diagnostics_agg")
    return typer_.fail(Code::kBadRosName, status.span,
                       "'" + status.text + "' is a topic, and no status",
                       "write the name or the hardware id of a status, as in level(motor)");
  Input wanted;
  wanted.kind = Input::Kind::kLevel;
  wanted.diagnostic = symbols_.diagnostic(status.text);
  return input(wanted, Type::kInt);
}

std::optional<Typed> CallTyper::changed(const Expression& e) {
  const auto signal = signal_argument(e);
  if (!signal) return std::nullopt;
  Input wanted;
  wanted.kind = Input::Kind::kChanged;
  wanted.signal = *signal;
  return input(wanted, Type::kBool);
}

std::optional<Typed> CallTyper::frozen(const Expression& e) {
  const auto signal = signal_argument(e);
  if (!signal) return std::nullopt;
  const auto length = window_argument(e.children[1]);
  if (!length) return std::nullopt;
  Input wanted;
  wanted.kind = Input::Kind::kFrozen;
  wanted.signal = *signal;
  wanted.window = *length;
  return input(wanted, Type::kBool);
}

std::optional<Typed> CallTyper::isnan(const Expression& e) {
  const auto signal = signal_argument(e);
  if (!signal) return std::nullopt;
  if (const auto type = symbols_.type_of(*signal); !type || !is_numeric(*type))
    return typer_.fail(Code::kTypeMismatch, e.children[0].span, "isnan needs a number", "");
  Input wanted;
  wanted.kind = Input::Kind::kIsNan;
  wanted.signal = *signal;
  return input(wanted, Type::kBool);
}

// parameter(fps, camera): reported.
bool CallTyper::is_swapped(const Expression& e) {
  const std::string& first = e.children[0].name.text;
  const std::string& second = e.children[1].name.text;
  if (symbols_.is_declared_component(first) || !symbols_.is_declared_component(second))
    return false;
  const Span both{e.children[0].span.begin, e.children[1].span.end};
  const std::string right = second + ", " + first;
  typer_.fail(Code::kArguments, both, "the component stands in front of its parameter",
              "write parameter(" + right + ")", Edit{both, right});
  return true;
}

// goals(/navigate, 1min, aborted): reported.
bool CallTyper::is_window_first(const Expression& e) {
  const Expression& second = e.children[2];
  if (second.kind != Expression::Kind::kName || !parse_duration(e.children[1].name.text))
    return false;
  const Span both{e.children[1].span.begin, second.span.end};
  const std::string right = second.name.text + ", " + e.children[1].name.text;
  typer_.fail(Code::kArguments, both, "the window stands at the end", "write " + right,
              Edit{both, right});
  return true;
}

std::optional<Typed> CallTyper::goals(const Expression& e) {
  const auto topic = action_argument(e.children[0]);
  if (!topic) return std::nullopt;
  const syntax::Name& word = e.children[1].name;
  const auto outcome = counted_outcome(word.text);
  if (!outcome && is_window_first(e)) return std::nullopt;
  if (!outcome) {
    const bool is_failure = word.text == "failed" || word.text == "failure";
    const std::string near = is_failure ? "aborted" : closest(word.text, counted_outcomes());
    return typer_.fail(Code::kArguments, word.span, "no goal ends as '" + word.text + "'",
                       near.empty() ? "write aborted, canceled, succeeded or accepted"
                                    : "did you mean '" + near + "'?",
                       replacement(word.span, near));
  }
  const auto length = window_argument(e.children[2]);
  if (!length) return std::nullopt;
  Input wanted;
  wanted.kind = Input::Kind::kGoals;
  wanted.topic = *topic;
  wanted.outcome = *outcome;
  wanted.window = *length;
  return input(wanted, Type::kInt);
}

std::optional<Typed> CallTyper::goal_age(const Expression& e) {
  const auto topic = action_argument(e.children[0]);
  if (!topic) return std::nullopt;
  Input wanted;
  wanted.kind = Input::Kind::kGoalAge;
  wanted.topic = *topic;
  return input(wanted, Type::kDuration);
}

std::optional<Typed> CallTyper::logs(const Expression& e) {
  const syntax::Name& word = e.children[1].name;
  const auto level = log_level(word.text);
  if (!level && is_window_first(e)) return std::nullopt;
  if (!level) {
    const std::string upper = upper_case(word.text);
    const std::string near = log_level(upper) ? upper : closest(upper, log_levels());
    return typer_.fail(
        Code::kArguments, word.span, "no log has the level '" + word.text + "'",
        near.empty() ? "write DEBUG, INFO, WARN, ERROR or FATAL" : "did you mean '" + near + "'?",
        replacement(word.span, near));
  }
  const auto length = window_argument(e.children[2]);
  if (!length) return std::nullopt;
  Input wanted;
  wanted.kind = Input::Kind::kLogs;
  wanted.component = symbols_.component(e.children[0].name);
  wanted.log_level = *level;
  wanted.window = *length;
  return input(wanted, Type::kInt);
}

std::optional<TopicId> CallTyper::action_argument(const Expression& e) {
  const std::string& name = e.name.text;
  if (name.starts_with('/') && is_component_reference(name))
    return symbols_.topic(name + std::string(kStatusOfAction));
  return typer_.fail(Code::kBadRosName, e.span, "'" + name + "' is no full name of an action",
                     "write it with its namespace, as in /navigate_to_pose");
}

std::optional<Typed> CallTyper::rate(const Expression& e) {
  constexpr Duration kDefaultWindow = std::chrono::seconds(2);
  const auto topic = topic_argument(e.children[0]);
  if (!topic) return std::nullopt;
  Input wanted;
  wanted.kind = Input::Kind::kRate;
  wanted.topic = *topic;
  wanted.window = kDefaultWindow;
  if (e.children.size() == 2) {
    const auto given = window_argument(e.children[1]);
    if (!given) return std::nullopt;
    wanted.window = *given;
  }
  return input(wanted, Type::kDouble);
}

// min and max of a signal over a time, not of two values: a bare signal and a duration.
bool CallTyper::is_window(const Expression& e) const {
  const Expression& first = e.children[0];
  return first.kind == Kind::kName && symbols_.constant(first.name.text) == nullptr &&
         e.children[1].kind == Kind::kLiteral &&
         std::holds_alternative<Duration>(*e.children[1].literal);
}

std::optional<Typed> CallTyper::window(const Expression& e, Input::Kind kind) {
  const auto signal = signal_argument(e);
  if (!signal) return std::nullopt;
  if (symbols_.type_of(*signal) != Type::kDouble) {
    return typer_.fail(Code::kTypeMismatch, e.children[0].span,
                       e.name.text + " over time needs a number", "");
  }
  const auto length = window_argument(e.children[1]);
  if (!length) return std::nullopt;
  Input wanted;
  wanted.kind = kind;
  wanted.signal = *signal;
  wanted.window = *length;
  return input(wanted, Type::kDouble);
}

std::optional<Duration> CallTyper::window_argument(const Expression& e) {
  auto typed = typer_.type(e);
  if (!typed) return std::nullopt;
  const bool constant = typed->type == Type::kDuration && !reads_inputs(*typed);
  const Slot slot = constant ? evaluate(compile(*typed), {}) : Slot();
  constexpr Duration kLongest = std::chrono::hours(24);
  if (!slot.known) {
    return typer_.fail(Code::kTypeMismatch, e.span, "a window is a constant duration",
                       "write for example 2s");
  }
  if (Duration(slot.i) <= Duration::zero())
    return typer_.fail(Code::kPolicyRange, e.span, "a window is longer than zero",
                       "write its length, as in 2s");
  if (Duration(slot.i) > kLongest) {
    return typer_.fail(Code::kLongWindow, e.span, "a window is at most a day long",
                       "write 24h or less; age(topic) > 36h notices silence that lasts longer");
  }
  return Duration(slot.i);
}

std::optional<SignalId> CallTyper::signal_argument(const Expression& call) {
  const Expression& e = call.children[0];
  const bool is_signal = e.kind == Kind::kName && symbols_.constant(e.name.text) == nullptr;
  if (is_signal) return symbols_.signal(e.name);
  return typer_.fail(Code::kArguments, e.span, "this must be a signal",
                     "usage: " + std::string(find_function(call.name.text)->usage));
}

std::optional<TopicId> CallTyper::topic_argument(const Expression& e) {
  if (e.name.text.starts_with('/') && is_component_reference(e.name.text)) {
    std::optional<ComponentId> publisher;
    if (!e.children.empty()) {
      const syntax::Name& name = e.children[0].name;
      if (!is_component_reference(name.text))
        return typer_.fail(Code::kBadRosName, name.span, "'" + name.text + "' names no component",
                           "write the name of a component, or the full name of its node");
      publisher = symbols_.component(name);
    }
    return symbols_.topic(e.name.text, publisher);
  }
  if (const auto bracket = e.name.text.find('['); bracket != std::string::npos)
    return window_in_brackets(e, bracket);
  if (const auto topic = symbols_.topic_of_signal(e.name.text); !topic.empty())
    return typer_.fail(Code::kBadRosName, e.span, "'" + e.name.text + "' is a signal, and no topic",
                       "write its topic, " + topic, Edit{e.span, topic});
  const std::string& written = e.name.text;
  if (symbols_.known_signal(written))
    return typer_.fail(Code::kBadRosName, e.span, "'" + written + "' is a signal, and no topic",
                       "write the topic that brings it; STALE limits the age of its value");
  if (symbols_.known_component(written))
    return typer_.fail(Code::kBadRosName, e.span, "'" + written + "' is a component, and no topic",
                       "write a topic that it publishes, as in /robot/camera/image");
  if (const std::string inside = written.size() < 2 ? "" : written.substr(1, written.size() - 2);
      written.starts_with('\'') && written.ends_with('\'') && inside.starts_with('/') &&
      is_component_reference(inside))
    return typer_.fail(Code::kBadRosName, e.span, "a topic has no quotes", "write " + inside,
                       Edit{e.span, inside});
  if (const std::string rest = written.substr(std::min<std::size_t>(1, written.size()));
      written.starts_with('"') && rest.starts_with('/') && is_component_reference(rest))
    return typer_.fail(Code::kBadToken, e.span, "this string has no closing '\"'",
                       "a topic has no quotes: write " + rest, Edit{e.span, rest});
  if (written.find('*') != std::string::npos)
    return typer_.fail(Code::kBadRosName, e.span, "'" + written + "' is no full topic name",
                       "there are no wildcards: write a rule for each topic, or a TEMPLATE and a "
                       "USE line for each");
  if (written.starts_with('$') || written.starts_with('{'))
    return typer_.fail(Code::kBadRosName, e.span, "'" + written + "' is no full topic name",
                       written.starts_with('$') ? "remove the '$': braces alone name a parameter"
                                                : "write one pair of braces around a parameter");
  if (const std::string topic = written.substr(0, written.find('.'));
      topic != written && topic.starts_with('/') && is_component_reference(topic))
    return typer_.fail(Code::kBadRosName, e.span, "'" + written + "' is a field, and no topic",
                       "write " + topic + "; only a SIGNAL reads a field", Edit{e.span, topic});
  return typer_.fail(Code::kBadRosName, e.span, "'" + written + "' is no full topic name",
                     written.starts_with('%') ? "a parameter of a TEMPLATE stands in braces"
                                              : remedy_of_ros_name(written));
}

// "rate(/scan[5m])"
std::nullopt_t CallTyper::window_in_brackets(const Expression& e, std::size_t bracket) {
  const std::string topic = e.name.text.substr(0, bracket);
  std::string window = e.name.text.substr(bracket + 1);
  if (window.ends_with(']')) window.pop_back();
  if (window.ends_with('m')) window += "in";
  const bool is_window = parse_duration(window).has_value();
  return typer_.fail(Code::kBadRosName, e.span, "unexpected brackets after a topic",
                     is_window ? "write " + topic + ", " + window + ": only rate takes a window"
                               : "write " + topic);
}

std::optional<Typed> CallTyper::extreme(const Expression& e, Op exact, Op real) {
  auto a = typer_.type(e.children[0]);
  if (!a) return std::nullopt;
  auto b = typer_.type(e.children[1]);
  if (!b) return std::nullopt;
  const bool ordered = a->type != Type::kBool && a->type != Type::kString;
  if (!ordered || !make_alike(*a, *b))
    return typer_.mismatch(e, a->type, b->type, "calculate with");
  const Type result = a->type;
  return typed_node(is_exact(result) ? exact : real, result, std::move(*a), std::move(*b));
}

std::optional<Typed> CallTyper::absolute(const Expression& e) {
  auto a = typer_.type(e.children[0]);
  if (!a) return std::nullopt;
  const Type t = a->type;
  if (is_exact(t)) return typed_node(Op::kAbsInt, t, std::move(*a));
  if (t == Type::kDouble) return typed_node(Op::kAbsDouble, t, std::move(*a));
  return typer_.fail(Code::kTypeMismatch, e.children[0].span,
                     std::string("abs needs a number; this is ") + describe(t), "");
}

std::optional<Typed> CallTyper::real_function(const Expression& e, Op op) {
  Typed result = typed_node(op, Type::kDouble);
  for (const Expression& child : e.children) {
    auto typed = typer_.type(child);
    if (!typed) return std::nullopt;
    const Type t = typed->type;
    auto real = converted(std::move(*typed), Type::kDouble);
    if (!real) {
      return typer_.fail(Code::kTypeMismatch, child.span,
                         e.name.text + " needs a number; this is " + describe(t), "");
    }
    result.children.push_back(std::move(*real));
  }
  return result;
}

}  // namespace

std::optional<Typed> type_call(const Expression& call, Typer& typer) {
  return CallTyper(typer).call(call);
}

}  // namespace culprit
