#include "language/occurrences.h"

#include <algorithm>
#include <set>

#include "language/functions.h"
#include "language/parser.h"

namespace culprit {
namespace {

using OccurrenceKind = Occurrence::Kind;

class Collector {
 public:
  // `scope`: the template whose body the file is; else empty.
  explicit Collector(const syntax::File& file, std::string scope = "")
      : file_(file), scope_(std::move(scope)) {
    for (const syntax::Constant& constant : file.constants) constants_.insert(constant.name.text);
    if (scope_.empty()) return;
    own_ = constants_;
    for (const syntax::Component& component : file.components) own_.insert(component.name.text);
    for (const syntax::Signal& signal : file.signals) own_.insert(signal.name.text);
    for (const syntax::Group& group : file.groups) own_.insert(group.name.text);
  }

  std::vector<Occurrence> collect() {
    find();
    std::stable_sort(all_.begin(), all_.end(), [](const Occurrence& a, const Occurrence& b) {
      return a.span.begin < b.span.begin;
    });
    return std::move(all_);
  }

 private:
  void find() {
    for (const syntax::Constant& c : file_.constants) {
      add(OccurrenceKind::kConstant, c.name, true);
      expression(c.value);
    }
    for (const syntax::Component& c : file_.components)
      add(OccurrenceKind::kComponent, c.name, true);
    for (const syntax::Dependency& d : file_.dependencies) {
      add(OccurrenceKind::kComponent, d.consumer);
      for (const syntax::Name& producer : d.producers) add(OccurrenceKind::kComponent, producer);
    }
    for (const syntax::Group& g : file_.groups) {
      add(OccurrenceKind::kSignal, g.name, true);
      for (const syntax::Name& member : g.members) add(OccurrenceKind::kComponent, member);
      add(OccurrenceKind::kComponent, g.manager);
    }
    for (const syntax::Name& topic : file_.ignored_topics) add(OccurrenceKind::kTopic, topic);
    for (const syntax::Interlock& i : file_.interlocks) expression(i.condition);
    for (const syntax::Interlock& a : file_.aborts) expression(a.condition);
    for (const syntax::Drill& d : file_.drills) {
      add(OccurrenceKind::kComponent, d.component);
      if (d.value) expression(*d.value);
    }
    for (const syntax::Signal& s : file_.signals) signal(s);
    for (const syntax::Rule& r : file_.rules) rule(r);
    for (const syntax::Include& i : file_.includes) add(OccurrenceKind::kFile, i.file);
    for (const syntax::Use& u : file_.uses) add(OccurrenceKind::kTemplate, u.pattern);
    for (const syntax::Template& t : file_.templates) {
      add(OccurrenceKind::kTemplate, t.name, true);
      for (const syntax::TemplateParameter& p : t.parameters)
        add(OccurrenceKind::kHole, p.name, true, t.name.text);
      auto inside = Collector(t.body, t.name.text).collect();
      all_.insert(all_.end(), inside.begin(), inside.end());
    }
  }

  void add(OccurrenceKind kind, const syntax::Name& name, bool declares = false,
           std::string scope = "") {
    if (name.text.empty() || (!scope_.empty() && has_hole(name.text))) return;
    if (scope.empty() && is_own(kind, name.text)) scope = scope_;
    all_.push_back({kind, name.text, std::move(scope), name.span, declares});
  }

  bool is_own(OccurrenceKind kind, const std::string& name) const {
    using enum Occurrence::Kind;
    return kind == kRule ||
           ((kind == kConstant || kind == kComponent || kind == kSignal) && own_.contains(name));
  }

  void add_ros_name(OccurrenceKind kind, const syntax::Name& name, const syntax::Name& component) {
    add(kind, name, false, name.text.starts_with('/') ? "" : component.text);
  }

  void signal(const syntax::Signal& s) {
    add(OccurrenceKind::kSignal, s.name, true);
    if (const auto* diagnostic = std::get_if<syntax::DiagnosticSource>(&s.source)) {
      add(OccurrenceKind::kDiagnostic, diagnostic->status);
    } else if (const auto* topic = std::get_if<syntax::TopicSource>(&s.source)) {
      add(OccurrenceKind::kTopic, topic->topic);
    } else if (const auto* parameter = std::get_if<syntax::ParameterSource>(&s.source)) {
      add(OccurrenceKind::kComponent, parameter->component);
      add(OccurrenceKind::kParameter, parameter->parameter, false, parameter->component.text);
    }
    if (s.from) add(OccurrenceKind::kComponent, *s.from);
  }

  void rule(const syntax::Rule& r) {
    add(OccurrenceKind::kRule, r.name, true);
    if (r.trigger) expression(*r.trigger);
    for (const syntax::Strategy& s : r.strategies) {
      add(OccurrenceKind::kStrategy, s.name, true, r.name.text);
      if (s.when) expression(*s.when);
      for (const syntax::Adaptation& a : s.adaptations) adaptation(a);
    }
  }

  void adaptation(const syntax::Adaptation& a) {
    const bool is_group = a.type == syntax::AdaptationType::kStartGroup;
    add(is_group ? OccurrenceKind::kSignal : OccurrenceKind::kComponent, a.component);
    if (syntax::names_parameter(a.type))
      add(OccurrenceKind::kParameter, a.subject, false, a.component.text);
    if (a.type == syntax::AdaptationType::kCall)
      add_ros_name(OccurrenceKind::kService, a.subject, a.component);
    add_ros_name(OccurrenceKind::kTopic, a.topic, a.component);
    if (a.value) expression(*a.value);
  }

  void expression(const syntax::Expression& e) {
    if (e.kind == syntax::Expression::Kind::kName) {
      const bool is_constant = constants_.contains(e.name.text);
      add(is_constant ? OccurrenceKind::kConstant : OccurrenceKind::kSignal, e.name);
      return;
    }
    const FunctionInfo* function = nullptr;
    if (e.kind == syntax::Expression::Kind::kCall) {
      add(OccurrenceKind::kFunction, e.name);
      function = find_function(e.name.text);
    }
    for (std::size_t i = 0; i < e.children.size(); ++i) {
      const bool has_place = function != nullptr && i < function->arguments.size();
      argument(e, i, has_place ? function->arguments[i] : Argument::kExpression);
    }
  }

  void argument(const syntax::Expression& call, std::size_t i, Argument place) {
    const syntax::Expression& e = call.children[i];
    switch (place) {
      case Argument::kTopic:
        add(OccurrenceKind::kTopic, e.name);
        for (const syntax::Expression& publisher : e.children)
          add(OccurrenceKind::kComponent, publisher.name);
        return;
      case Argument::kComponent:
        return add(OccurrenceKind::kComponent, e.name);
      case Argument::kParameter:
        return add(OccurrenceKind::kParameter, e.name, false, call.children[0].name.text);
      case Argument::kAction:
        return add(OccurrenceKind::kAction, e.name);
      case Argument::kOutcome:
      case Argument::kLogLevel:
        return;
      case Argument::kDiagnostic:
        return add(OccurrenceKind::kDiagnostic, e.name);
      case Argument::kExpression:
        return expression(e);
    }
  }

  const syntax::File& file_;
  const std::string scope_;
  std::set<std::string> constants_;
  std::set<std::string> own_;  // what the template declares
  std::vector<Occurrence> all_;
};

}  // namespace

std::vector<Occurrence> occurrences(const syntax::File& file) { return Collector(file).collect(); }

std::vector<Occurrence> occurrences(const syntax::File& file, const Source& source) {
  std::vector<Occurrence> all = occurrences(file);
  if (file.templates.empty()) return all;
  std::vector<Diagnostic> said;
  std::vector<Lexeme> lexemes;
  parse(source, said, &lexemes);
  for (const syntax::Template& t : file.templates) {
    auto lexeme = std::lower_bound(
        lexemes.begin(), lexemes.end(), t.lines.begin,
        [](const Lexeme& each, std::uint32_t begin) { return each.span.begin < begin; });
    for (; lexeme != lexemes.end() && lexeme->span.begin < t.lines.end; ++lexeme) {
      for (std::uint32_t at = lexeme->span.begin; at < lexeme->span.end; ++at) {
        const std::string_view rest = source.text({at, lexeme->span.end});
        const auto length = static_cast<std::uint32_t>(hole_length(rest));
        if (length == 0) continue;
        const Span name{at + 1, at + length - 1};
        all.push_back({OccurrenceKind::kHole, std::string(source.text(name)), t.name.text, name});
      }
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Occurrence& a, const Occurrence& b) {
    return a.span.begin < b.span.begin;
  });
  return all;
}

const Occurrence* occurrence_at(const std::vector<Occurrence>& all, std::uint32_t offset) {
  const auto found = std::find_if(all.begin(), all.end(), [offset](const Occurrence& o) {
    return o.span.begin <= offset && offset <= o.span.end;
  });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace culprit
