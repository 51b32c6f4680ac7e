#include "language/reparse.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include "language/parser.h"

namespace culprit {
namespace {

// Moves all places of a part of a tree. Each structure is taken apart into all its members, so one
// that gets another does not compile before somebody thought of it here.
class Mover {
 public:
  explicit Mover(std::uint32_t by) : by_(by) {}

  void move(Span& span) const {
    if (span == Span{}) return;  // of a part that is not there
    span.begin += by_;
    span.end += by_;
  }
  void move(Diagnostic& d) const {
    move(d.span);
    if (d.fix) move(d.fix->span);
  }
  void move(syntax::Name& name) const { move(name.span); }
  void move(syntax::Number& number) const { move(number.span); }
  void move(syntax::Expression& e) const {
    auto& [kind, op, span, literal, name, children] = e;
    move(span);
    move(name);
    move(children);
  }
  void move(syntax::File::Cycle& cycle) const { move(cycle.span); }
  void move(syntax::Constant& c) const {
    auto& [name, value] = c;
    move(name);
    move(value);
  }
  void move(syntax::Component& c) const {
    auto& [name, node, launch, setup, environment, folder, is_required, is_respawned, ready, unit,
           is_users_unit, engine, engine_container, host, container, plugin, package, parameters,
           remaps, lifecycle, other_nodes] = c;
    move(name);
    move(node);
    move(launch);
    for (auto* part : {&setup, &environment, &folder, &unit, &engine, &engine_container, &host,
                       &container, &plugin, &package, &parameters, &remaps})
      move(*part);
    move(other_nodes);
  }
  void move(syntax::Dependency& d) const {
    auto& [consumer, producers] = d;
    move(consumer);
    move(producers);
  }
  void move(syntax::Group& g) const {
    auto& [name, members, manager] = g;
    move(name);
    move(members);
    move(manager);
  }
  void move(syntax::DiagnosticSource& s) const {
    auto& [status, key] = s;
    move(status);
    move(key);
  }
  void move(syntax::TopicSource& s) const {
    auto& [topic, field] = s;
    move(topic);
    move(field);
  }
  void move(syntax::ParameterSource& s) const {
    auto& [component, parameter] = s;
    move(component);
    move(parameter);
  }
  void move(syntax::Signal::Range& r) const { move(r.span); }
  void move(syntax::Signal& s) const {
    auto& [name, source, stale, range, from] = s;
    move(name);
    std::visit([this](auto& which) { move(which); }, source);
    move(range);
    move(from);
  }
  void move(syntax::Adaptation& a) const {
    auto& [component, type, subject, topic, request, value, impact, span, begins_step] = a;
    move(component);
    move(subject);
    move(topic);
    move(request);
    move(value);
    move(impact);
    move(span);
  }
  void move(syntax::Strategy& s) const {
    auto& [name, probability, confidence, when, adaptations, is_last_resort, within, is_broken] = s;
    move(name);
    move(probability);
    move(confidence);
    move(when);
    move(adaptations);
  }
  void move(syntax::Policies::Hold& h) const { move(h.span); }
  void move(syntax::Policies::Attempts& a) const { move(a.span); }
  void move(syntax::Policies& p) const {
    auto& [criticality, hold_for, hold, cooldown, attempts, on_change, is_report, span] = p;
    move(hold);
    move(attempts);
    move(span);
  }
  void move(syntax::Rule& r) const {
    auto& [name, policies, trigger, strategies, has_broken_part, begin] = r;
    move(name);
    move(policies);
    move(trigger);
    move(strategies);
    begin += by_;
  }
  void move(syntax::Interlock& i) const {
    auto& [condition, text] = i;
    move(condition);
  }
  void move(syntax::Drill& d) const {
    auto& [component, what, subject, value, times] = d;
    move(component);
    move(subject);
    move(value);
  }
  void move(syntax::BrokenDeclaration& b) const { move(b.name); }
  void move(syntax::Include& i) const {
    auto& [file, span] = i;
    move(file);
    move(span);
  }
  void move(syntax::Use& u) const {
    auto& [pattern, arguments, in, span] = u;
    move(pattern);
    move(arguments);
    move(in);
    move(span);
  }
  void move(syntax::TemplateParameter& p) const {
    auto& [name, usual] = p;
    move(name);
    move(usual);
  }
  void move(syntax::Template& t) const {
    auto& [name, parameters, body, span, lines] = t;
    move(name);
    move(parameters);
    move(body);
    move(span);
    move(lines);
  }
  void move(syntax::File& f) const {
    auto& [robot, cycle, constants, components, dependencies, groups, ignored_topics, interlocks,
           aborts, drills, signals, rules, broken_declarations, includes, templates, uses] = f;
    move(robot);
    move(cycle);
    move(constants);
    move(components);
    move(dependencies);
    move(groups);
    move(ignored_topics);
    move(interlocks);
    move(aborts);
    move(drills);
    move(signals);
    move(rules);
    move(broken_declarations);
    move(includes);
    move(templates);
    move(uses);
  }

 private:
  template <class T>
  void move(std::optional<T>& part) const {
    if (part) move(*part);
  }
  template <class T>
  void move(Seldom<T>& part) const {
    if (part) move(*part);
  }
  template <class T>
  void move(std::vector<T>& parts) const {
    if (by_ == 0) return;
    for (T& part : parts) move(part);
  }

  std::uint32_t by_;  // modulo 2^32, as unsigned numbers count: also backwards
};

// Some place in the lines of a part, by which the tree is cut between lines.
std::uint32_t place_of(const syntax::Name& name) { return name.span.begin; }
std::uint32_t place_of(const syntax::File::Cycle& cycle) { return cycle.span.begin; }
std::uint32_t place_of(const syntax::Dependency& d) { return place_of(d.consumer); }
std::uint32_t place_of(const syntax::Interlock& i) { return i.condition.span.begin; }
std::uint32_t place_of(const syntax::Drill& d) { return place_of(d.component); }
std::uint32_t place_of(const syntax::Rule& r) { return r.begin; }
std::uint32_t place_of(const syntax::Include& i) { return i.span.begin; }
std::uint32_t place_of(const syntax::Template& t) { return t.span.begin; }
std::uint32_t place_of(const syntax::Use& u) { return u.span.begin; }
std::uint32_t place_of(const Diagnostic& d) { return d.span.begin; }
template <class Declaration>
std::uint32_t place_of(const Declaration& d) {
  return place_of(d.name);
}

// Parts are in the order of the text. Moves the parts from `place` on to the end of `to`.
template <class T>
void cut(std::vector<T>& from, std::uint32_t place, std::vector<T>& to) {
  const auto tail = std::partition_point(from.begin(), from.end(),
                                         [&](const T& part) { return place_of(part) < place; });
  to.insert(to.end(), std::make_move_iterator(tail), std::make_move_iterator(from.end()));
  from.erase(tail, from.end());
}
template <class T>
void cut(std::optional<T>& from, std::uint32_t place, std::optional<T>& to) {
  if (from && place_of(*from) >= place) to = std::exchange(from, std::nullopt);
}
void cut(syntax::File& from, std::uint32_t place, syntax::File& to) {
  auto& [robot, cycle, constants, components, dependencies, groups, ignored_topics, interlocks,
         aborts, drills, signals, rules, broken_declarations, includes, templates, uses] = from;
  cut(robot, place, to.robot);
  cut(cycle, place, to.cycle);
  cut(constants, place, to.constants);
  cut(components, place, to.components);
  cut(dependencies, place, to.dependencies);
  cut(groups, place, to.groups);
  cut(ignored_topics, place, to.ignored_topics);
  cut(interlocks, place, to.interlocks);
  cut(aborts, place, to.aborts);
  cut(drills, place, to.drills);
  cut(signals, place, to.signals);
  cut(rules, place, to.rules);
  cut(broken_declarations, place, to.broken_declarations);
  cut(includes, place, to.includes);
  cut(templates, place, to.templates);
  cut(uses, place, to.uses);
}

// How much two texts have in common at their begins and, beside that, at their ends.
struct Common {
  std::uint32_t front = 0;
  std::uint32_t back = 0;
};
Common common(std::string_view a, std::string_view b) {
  const std::size_t most = std::min(a.size(), b.size());
  const auto front =
      std::mismatch(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(most), b.begin()).first -
      a.begin();
  const auto left = static_cast<std::ptrdiff_t>(most) - front;
  const auto back = std::mismatch(a.rbegin(), a.rbegin() + left, b.rbegin()).first - a.rbegin();
  return {static_cast<std::uint32_t>(front), static_cast<std::uint32_t>(back)};
}

// Places where a tree can be cut: at the begin of such a line the parser is in the same state as at
// the begin of a text, or comes to the same state from any.
class Cuts {
 public:
  // Up to `plain_end` no rule and no template has begun, and no part of a rule stands there.
  Cuts(const std::vector<syntax::Rule>& rules, std::uint32_t plain_end)
      : rules_(rules), plain_end_(plain_end) {}

  // The last one whose state follows from the first `size` bytes of `text` alone.
  std::uint32_t last_in(std::string_view text, std::uint32_t size) const {
    auto rule = first_rule_at(size);
    while (rule != rules_.begin()) {
      --rule;
      if (!rule->has_broken_part && text.find('\n', rule->begin) < size) return rule->begin;
    }
    const std::uint32_t plain = std::min(size, plain_end_);
    if (plain == 0) return 0;
    const std::size_t before = text.rfind('\n', plain - 1);
    return before == std::string_view::npos ? 0 : static_cast<std::uint32_t>(before + 1);
  }

  // Whether the line that begins at `line` is one, for a parser that is within a rule or not.
  bool has(std::uint32_t line, bool is_in_rule) const {
    if (!is_in_rule && line <= plain_end_) return true;
    const auto rule = first_rule_at(line);
    return rule != rules_.end() && rule->begin == line && !rule->has_broken_part;
  }

 private:
  std::vector<syntax::Rule>::const_iterator first_rule_at(std::uint32_t place) const {
    return std::partition_point(rules_.begin(), rules_.end(),
                                [&](const syntax::Rule& r) { return r.begin < place; });
  }

  const std::vector<syntax::Rule>& rules_;
  const std::uint32_t plain_end_;
};

std::uint32_t plain_end_of(const syntax::File& file) {
  // A part of a rule that stands before any RULE line breaks the rule that follows, which may be
  // one of a template.
  if (file.rules.empty() || file.rules.front().has_broken_part) return 0;
  const std::uint32_t rule = file.rules.front().begin;
  return !file.templates.empty() && file.templates.front().span.begin < rule ? 0 : rule;
}

}  // namespace

Parsed parse_whole(Source source) {
  Parsed out{std::move(source), {}, {}};
  out.file = parse(out.source, out.said);
  return out;
}

Parsed reparse(Parsed before, Source source) {
  const std::string_view old_text = before.source.text();
  const Common same = common(old_text, source.text());
  const auto old_size = static_cast<std::uint32_t>(old_text.size());
  const auto moved_by = static_cast<std::uint32_t>(source.text().size()) - old_size;  // mod 2^32
  const std::uint32_t plain_end = plain_end_of(before.file);
  const std::uint32_t begin = Cuts(before.file.rules, plain_end).last_in(old_text, same.front);

  Parsed rest{std::move(before.source), {}, {}};  // of the old text from `begin` on
  cut(before.file, begin, rest.file);
  cut(before.said, begin, rest.said);

  // A line is known if the tree can be cut there, and the line and all after it are unchanged; the
  // line end before it, too. A report about a second ROBOT or CYCLE stays the same as long as there
  // was a first one before, or there is still none.
  const bool has_robot = before.file.robot.has_value();
  const bool has_cycle = before.file.cycle.has_value();
  const auto was_set_before = [](const auto& part, std::uint32_t place) {
    return part && place_of(*part) < place;
  };
  const Cuts cuts(rest.file.rules, plain_end);
  const auto is_known = [&](std::uint32_t line, bool is_in_rule) {
    if (line <= source.text().size() - same.back) return false;
    const std::uint32_t was = line - moved_by;
    return cuts.has(was, is_in_rule) &&
           before.file.robot.has_value() == (has_robot || was_set_before(rest.file.robot, was)) &&
           before.file.cycle.has_value() == (has_cycle || was_set_before(rest.file.cycle, was));
  };
  const std::uint32_t end = parse_lines(source, begin, is_known, before.file, before.said);
  if (end < source.text().size()) {
    Parsed tail{Source("", ""), {}, {}};
    cut(rest.file, end - moved_by, tail.file);
    cut(rest.said, end - moved_by, tail.said);
    const Mover mover(moved_by);
    mover.move(tail.file);
    for (Diagnostic& d : tail.said) mover.move(d);
    cut(tail.file, 0, before.file);
    cut(tail.said, 0, before.said);
  }
  before.source = std::move(source);
  return before;
}

}  // namespace culprit
