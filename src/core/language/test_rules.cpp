#include "language/test_rules.h"

#include <algorithm>
#include <rapidcheck.h>

#include "language/functions.h"
#include "language/syntax.h"

namespace culprit {
namespace {

int below(int n) { return *rc::gen::inRange(0, n); }
bool coin() { return below(2) == 0; }

std::string pick(const std::vector<std::string>& from) { return *rc::gen::elementOf(from); }

std::string blanks() { return pick({" ", " ", "  ", "\t", "   \t ", "\r ", "\f", "\v"}); }
std::string maybe_blanks() { return coin() ? "" : blanks(); }

// Whether what is written stands in a template, whose parameters are p and of_q.
bool inside_template = false;

// One time in a few, in a template.
bool with_parameter() { return inside_template && below(4) == 0; }

std::string identifier() {
  if (with_parameter()) return pick({"{p}", "{p}_silent", "of_{of_q}{p}", "x2{of_q}"});
  return pick({"a", "camera", "image_enhancement", "_x", "B2", "rate", "a_name_of_some_length"});
}
std::string ros_name() {
  if (with_parameter()) return pick({"{p}", "/{p}/scan", "/robot/{of_q}", "\"{p}/b\""});
  return pick({"/t", "/robot/camera", "/a/b_2/c", "\"/quoted\""});
}
std::string component() { return coin() ? identifier() : "/robot/" + identifier(); }
std::string name() {
  if (with_parameter()) return pick({"{p}", "{p}.x", "~/{of_q}", "\"{p} {p}\""});
  return pick({"gain", "pose.position.x", "ranges[0]", "~/routine", "2d", "-", "x=1",
               "\"two words\"", "\"# \\\" \"", "kühl", "rate", "WHEN", "STALE", "a:b", "<2"});
}
std::string text() {
  if (with_parameter()) return pick({"\"{p}\"", "\"run {of_q} {p}\"", "\"{a: {p}}\""});
  return pick({"\"\"", "\"active\"", "\"a  b\"", "\"\\\"\\\\\\n\\t\"", "\"# none\"", "\"// none\"",
               "\"größer\""});
}
std::string whole() {
  if (with_parameter()) return "{p}";
  return pick({"0", "1", "7", "100", "9223372036854775807"});
}
std::string number() { return coin() ? whole() : pick({"0.06", ".5", "3.", "1e3", "2.5E-2"}); }
std::string duration() {
  if (with_parameter()) return pick({"{of_q}", "{p}ms"});
  return pick({"500ms", "2s", "1.5min", "10us", ".5h", "7ns", "1e3ms"});
}

// ---- Expressions

std::string expression(int depth);

std::string call(int depth) {
  const std::vector<std::string_view> names = function_names();
  const FunctionInfo& function =
      *find_function(names[static_cast<std::size_t>(below(static_cast<int>(names.size())))]);
  const std::size_t count = function.min_arguments == function.max_arguments || coin()
                                ? function.min_arguments
                                : function.max_arguments;
  std::string out = std::string(function.name) + maybe_blanks() + "(";
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) out += maybe_blanks() + ",";
    const bool is_expression = function.arguments[i] == Argument::kExpression;
    out += maybe_blanks() + (is_expression ? expression(depth) : coin() ? name() : ros_name());
    if (function.arguments[i] == Argument::kTopic && coin()) out += " FROM " + component();
  }
  return out + maybe_blanks() + ")";
}

std::string leaf() {
  switch (below(6)) {
    case 0:
      return number();
    case 1:
      return duration();
    case 2:
      return text();
    case 3:
      return pick({"true", "false"});
    default:
      return identifier();
  }
}

std::string operand(int depth) {
  switch (depth <= 0 ? 0 : below(6)) {
    case 0:
    case 1:
      return leaf();
    case 2:
      return call(depth - 1);
    case 3:
      return "(" + maybe_blanks() + expression(depth - 1) + maybe_blanks() + ")";
    default:
      return pick({"!", "-", "+"}) + maybe_blanks() + operand(depth - 1);
  }
}

// Operands and operators in a row, of any precedence.
std::string chain(int depth) {
  std::string out = operand(depth);
  for (int n = below(3); n > 0; --n) {
    const std::string op =
        pick({"||", "&&", "==", "!=", "<", "<=", ">", ">=", "+", "-", "*", "/", "%"});
    // "<a>" would be a placeholder.
    out += maybe_blanks() + op + (op == "<" ? " " : maybe_blanks()) + operand(depth);
  }
  return out;
}

std::string expression(int depth) {
  std::string out = chain(depth);
  if (depth > 0 && below(5) == 0) {
    out += maybe_blanks() + "?" + maybe_blanks() + expression(depth - 1) + maybe_blanks() + ":" +
           maybe_blanks() + expression(depth - 1);
  }
  return out;
}

// ---- Statements

std::string words(const std::vector<std::string>& pieces) {
  std::string out;
  for (const std::string& piece : pieces) {
    if (piece.empty()) continue;
    if (!out.empty()) out += blanks();
    out += piece;
  }
  return out;
}

std::string maybe(const std::string& piece) { return coin() ? piece : ""; }

std::string range() {
  const std::string low = maybe("-") + number();
  const std::string high = maybe("-") + number();
  const bool points_meet = low.ends_with('.') || high.starts_with('.');
  return words({"RANGE", low + (points_meet ? " " : maybe_blanks()) + ".." +
                             (points_meet ? " " : maybe_blanks()) + high});
}

std::string component_line() {
  const std::string other = "/" + identifier() + "/" + identifier();
  const std::string node = maybe(words({"NODE", ros_name(), maybe(other)}));
  const std::string launch = maybe(words({"LAUNCH", text()}));
  const std::string around = words({maybe(words({"ENV", text()})), maybe(words({"SETUP", name()})),
                                    maybe(words({"CWD", name()}))});
  const std::string required = words({maybe("REQUIRED"), maybe(words({"READY", duration()}))});
  const std::string respawned = maybe("RESPAWNED");
  const std::string unit = maybe(words({"UNIT", name(), maybe("USER")}));
  const std::string composed =
      words({maybe(words({"CONTAINER", name(), name()})), maybe(words({"HOST", name()})),
             maybe(words({"IN", ros_name()})), maybe(words({"PLUGIN", name()})),
             maybe(words({"PACKAGE", name()})), maybe(words({"PARAMETERS", name()})),
             maybe(words({"REMAP", name()}))});
  const char* driver = coin() ? "self" : coin() ? "managed" : "launcher";
  const std::string lifecycle = maybe(words({"LIFECYCLE", driver}));
  return coin() ? words({"COMPONENT", identifier(), node, launch, around, unit, composed, respawned,
                         required, lifecycle})
                : words({"COMPONENT", identifier(), lifecycle, required, respawned, composed, unit,
                         around, launch, node});
}

std::string signal_line() {
  std::string source;
  const std::string from = maybe(words({"FROM", component()}));
  switch (below(3)) {
    case 0:
      source = words({"DIAGNOSTIC", name(), "KEY", name(), from});
      break;
    case 1:
      source = words({"TOPIC", ros_name(), "FIELD", name(), from});
      break;
    default:
      source = words({"PARAMETER", component(), name()});
  }
  const std::string stale = maybe(words({"STALE", duration()}));
  const std::string bounds = maybe(range());
  return coin() ? words({"SIGNAL", identifier(), source, stale, bounds})
                : words({"SIGNAL", identifier(), source, bounds, stale});
}

std::string declaration() {
  switch (below(9)) {
    case 8:
      return words({"GROUP", identifier(),
                    "{" + maybe_blanks() + identifier() + maybe_blanks() +
                        maybe("," + maybe_blanks() + identifier() + maybe_blanks()) + "}",
                    "MANAGER", identifier()});
    case 0:
      return words({"CONST", identifier() + maybe_blanks() + "=" + maybe_blanks() + expression(2)});
    case 1:
      return component_line();
    case 2:
      return words({"DEPENDENCY", component(), "ON", component(), maybe(component())});
    case 3:
      return words({"IGNORE", "TOPIC", ros_name(), maybe(ros_name())});
    case 4:
      return words({"INTERLOCK", expression(2)});
    case 5:
      return words({"ABORT", expression(2)});
    case 6:
      return words(
          {"DRILL", component(), pick({"set_parameter gain 0.5", "without hang", "limit 3"})});
    default:
      return signal_line();
  }
}

std::string policies_line() {
  const std::string hold =
      words({"HOLD", whole() + maybe_blanks() + "/" + maybe_blanks() + whole()});
  std::vector<std::string> clauses = {maybe(words({"FOR", duration()})),
                                      maybe(hold),
                                      maybe(words({"COOLDOWN", duration()})),
                                      maybe(words({"ATTEMPTS", whole()})),
                                      maybe("ON_CHANGE"),
                                      maybe("REPORT")};
  std::rotate(clauses.begin(), clauses.begin() + below(6), clauses.end());
  return words({"POLICIES", pick({"NON_CRITICAL", "WARNING", "ERROR", "OK", "DEGRADED", "FAILURE"}),
                words(clauses)});
}

std::string adaptation_line() {
  using enum syntax::AdaptationType;
  const std::string word(*rc::gen::elementOf(syntax::adaptation_keywords()));
  std::string arguments;
  switch (*syntax::adaptation_type(word)) {
    case kSetParameter:
    case kIncreaseParameter:
    case kDecreaseParameter:
      arguments = words({name(), expression(2)});
      break;
    case kChangeCommunication:
      arguments = words({name(), name()});
      break;
    case kChangeMode:
      arguments = name();
      break;
    case kCall:
      arguments = words({name(), maybe(text())});
      break;
    default:
      break;
  }
  return words({"ADAPTATION", component(), word, arguments, number()});
}

// ---- Lines

class File {
 public:
  void line(const std::string& statement) {
    noise();
    out_.text += maybe_blanks() + statement;
    if (below(4) == 0) comment();
    end_line();
  }

  // Empty lines and lines of comments.
  void noise() {
    for (int n = below(3); n > 0; --n) {
      out_.text += maybe_blanks();
      if (coin()) comment();
      end_line();
    }
  }

  RuleText take() {
    noise();
    if (coin()) out_.text += below(2) == 0 ? "# the last line" : " ";
    if (out_.text.ends_with("line")) out_.comments.push_back("# the last line");
    return std::move(out_);
  }

 private:
  void comment() {
    const std::string text =
        pick({"#", "//", "# ", "#!", "/// "}) +
        pick({"", "why", "\"quoted", "a  b", "é ─┬─>", "RULE x", "# again // again", "<name>"}) +
        std::to_string(out_.comments.size());
    out_.text += maybe_blanks() + text + maybe_blanks();
    out_.comments.push_back(text);
  }

  void end_line() { out_.text += coin() ? "\n" : "\r\n"; }

  RuleText out_;
};

void rule(File& file) {
  file.line(words({"RULE", identifier()}));
  const std::string policies = policies_line();
  const std::string trigger = words({"TRIGGER", expression(3)});
  const bool swapped = below(4) == 0;
  file.line(swapped ? trigger : policies);
  file.line(swapped ? policies : trigger);
  for (int strategies = below(3); strategies >= 0; --strategies) {
    file.line(words({"STRATEGY", identifier(), number(), number(),
                     maybe(words({"LASTRESORT", maybe(words({"WITHIN", duration()}))})),
                     maybe(words({"WHEN", expression(2)}))}));
    file.line(adaptation_line());
    for (int adaptations = below(3); adaptations > 0; --adaptations)
      file.line(words({maybe("THEN"), adaptation_line()}));
    if (below(8) == 0) file.line(declaration());
  }
}

// ---- Reuse

std::string arguments() {
  if (below(4) == 0) return coin() ? "" : maybe_blanks() + "(" + maybe_blanks() + ")";
  std::string out = maybe_blanks() + "(";
  for (int n = below(3); n >= 0; --n) {
    out += maybe_blanks() + pick({"lidar", "/scan", "10", "-2.5", "500ms", "\"a text\"", "~/x"}) +
           maybe_blanks() + (n > 0 ? "," : "");
  }
  return out + ")";
}

std::string use_line() {
  return words({"USE", identifier() + arguments(), maybe(words({"IN", "/robot1"}))});
}

void rule_template(File& file) {
  file.line(words({"TEMPLATE", identifier() + maybe_blanks() + "(" + maybe_blanks() + "p" +
                                   maybe_blanks() + ", of_q" +
                                   maybe(" = " + pick({"5", "/t", "\"a b\""})) + ")"}));
  inside_template = true;
  for (int declarations = below(3); declarations > 0; --declarations) file.line(declaration());
  for (int rules = below(2); rules >= 0; --rules) {
    rule(file);
    if (below(4) == 0) file.line(use_line());
  }
  inside_template = false;
  file.line("END");
}

// Ends a rule.
void reuse(File& file) {
  switch (below(3)) {
    case 0:
      return file.line(words({"INCLUDE", pick({"\"packs/nav2.rules\"", "\"a \\\"b\\\".rules\""})}));
    case 1:
      return file.line(use_line());
    default:
      return rule_template(file);
  }
}

}  // namespace

RuleText random_rule_text() {
  File file;
  if (coin()) file.line(words({"ROBOT", identifier()}));
  if (coin()) file.line(words({"CYCLE", duration()}));
  for (int declarations = below(6); declarations > 0; --declarations) file.line(declaration());
  if (below(4) == 0) reuse(file);
  for (int rules = below(3); rules > 0; --rules) {
    rule(file);
    if (below(4) == 0) reuse(file);
  }
  return file.take();
}

}  // namespace culprit
