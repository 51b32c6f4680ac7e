#include "language/test_tree.h"

#include <sstream>

namespace culprit {
namespace {

using namespace syntax;

// Every part in brackets, texts with their length in front: no two trees read alike.
class Writer {
 public:
  std::string text() const { return out_.str(); }

  void put(bool b) { out_ << (b ? "true " : "false "); }
  void put(std::int64_t i) { out_ << i << ' '; }
  void put(double d) { out_ << std::hexfloat << d << ' '; }
  void put(Duration d) { out_ << d.count() << "ns "; }
  void put(const std::string& s) { out_ << s.size() << ':' << s << ' '; }
  void put(const Name& name) { put(name.text); }
  void put(const Literal& literal) {
    out_ << literal.index() << '=';
    std::visit([this](const auto& value) { put(value); }, literal);
  }

  void put(const Expression& e) {
    out_ << '(' << static_cast<int>(e.kind) << ' ' << static_cast<int>(e.op) << ' ';
    put(e.literal);
    put(e.name);
    put(e.children);
    out_ << ')';
  }
  void put(const Number& n) {
    put(n.value);
    put(n.whole);
  }

  void put(const syntax::Constant& c) { all(c.name, c.value); }
  void put(const syntax::Component& c) {
    all(c.name, c.node, c.launch, c.setup, c.environment, c.folder, c.is_required, c.is_respawned,
        c.ready, c.unit, c.is_users_unit, c.engine, c.engine_container, c.host, c.container,
        c.plugin, c.package, c.parameters, c.remaps, static_cast<std::int64_t>(c.lifecycle),
        c.other_nodes);
  }
  void put(const syntax::Dependency& d) { all(d.consumer, d.producers); }
  void put(const syntax::Group& g) { all(g.name, g.members, g.manager); }
  void put(const DiagnosticSource& s) { all(s.status, s.key); }
  void put(const TopicSource& s) { all(s.topic, s.field); }
  void put(const ParameterSource& s) { all(s.component, s.parameter); }
  void put(const syntax::Signal::Range& r) { all(r.low, r.high); }
  void put(const syntax::Signal& s) {
    all(s.name, static_cast<std::int64_t>(s.source.index()), s.stale, s.range, s.from);
    std::visit([this](const auto& source) { put(source); }, s.source);
  }

  void put(const syntax::Adaptation& a) {
    all(a.component, std::string(keyword(a.type)), a.subject, a.topic, a.request, a.value, a.impact,
        a.begins_step);
  }
  void put(const syntax::Strategy& s) {
    all(s.name, s.probability, s.confidence, s.when, s.adaptations, s.is_last_resort, s.within,
        s.has_broken_adaptation);
  }
  void put(const syntax::Interlock& i) { put(i.condition); }  // its text is how it is written
  void put(const syntax::Drill& d) {
    all(d.component, static_cast<std::int64_t>(d.what), d.subject, d.value, d.times);
  }
  void put(const syntax::Policies::Hold& h) { all(h.needed, h.window); }
  void put(const syntax::Policies::Attempts& a) { all(a.count); }
  void put(const syntax::Policies& p) {
    all(static_cast<std::int64_t>(p.criticality), p.hold_for, p.hold, p.cooldown, p.attempts,
        p.on_change, p.is_report);
  }
  void put(const syntax::Rule& r) {
    all(r.name, r.policies, r.trigger, r.strategies, r.has_broken_part);
  }
  void put(const File::Cycle& c) { all(c.length); }
  void put(const Include& i) { all(i.file); }
  void put(const TemplateParameter& p) { all(p.name, p.usual); }
  void put(const Use& u) { all(u.pattern, u.arguments, u.in); }
  void put(const Template& t) { all(t.name, t.parameters, t.body); }
  void put(const File& f) {
    all(f.robot, f.cycle, f.constants, f.components, f.dependencies, f.groups, f.ignored_topics,
        f.interlocks, f.aborts, f.drills, f.signals, f.rules, f.includes, f.templates, f.uses);
  }

 private:
  template <class T>
  void put(const std::optional<T>& part) {
    out_ << (part ? '[' : '-');
    if (part) put(*part);
    out_ << (part ? "]" : " ");
  }
  template <class T>
  void put(const Seldom<T>& part) {
    put(part ? std::optional<T>(*part) : std::nullopt);
  }
  template <class T>
  void put(const std::vector<T>& parts) {
    out_ << '{';
    for (const T& part : parts) put(part);
    out_ << '}';
  }
  template <class... Parts>
  void all(const Parts&... parts) {
    out_ << "\n<";
    (put(parts), ...);
    out_ << '>';
  }

  std::ostringstream out_;
};

}  // namespace

std::string tree_text(const syntax::File& file) {
  Writer writer;
  writer.put(file);
  return writer.text();
}

}  // namespace culprit
