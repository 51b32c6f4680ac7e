#include "language/rule_memory.h"

#include <sstream>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/checker.h"
#include "language/test_edits.h"

namespace culprit {
namespace {

// All of a rule set that somebody goes by.
class RuleSetText {
 public:
  explicit RuleSetText(const RuleSet& rules) {
    out_ << rules.robot << rules.cycle.count() << ' ' << rules.heaviest.count << '\n';
    for (const Component& c : rules.components) out_ << c.name << c.declared << c.node << '\n';
    for (const Topic& t : rules.topics) out_ << t.name << '\n';
    for (const Parameter& p : rules.parameters) out_ << p.component.index << p.name << '\n';
    for (const StatusLevel& d : rules.diagnostics) out_ << d.name << '\n';
    for (const Signal& s : rules.signals) out_ << s.name << to_string(s.type) << '\n';
    for (const Input& input : rules.inputs) put(input);
    for (const Rule& rule : rules.rules) put(rule);
    for (const Strategy& strategy : rules.strategies) put(strategy);
    for (const Dependency& d : rules.dependencies)
      out_ << d.consumer.index << ' ' << d.producer.index << '\n';
    for (const Interlock& i : rules.interlocks) put(i.condition);
  }
  std::string text() const { return out_.str(); }

 private:
  template <class IdType>
  void put(const std::vector<IdType>& ids) {
    for (const IdType id : ids) out_ << id.index << ' ';
    out_ << '\n';
  }
  void put(const Input& i) {
    out_ << static_cast<int>(i.kind) << to_string(i.type) << i.topic.index << ' ' << i.signal.index
         << ' ' << i.component.index << ' ' << i.parameter.index << ' ' << i.diagnostic.index << ' '
         << i.window.count() << i.only_compared;
    for (const double threshold : i.thresholds) out_ << ' ' << threshold;
    out_ << '\n';
    put(i.readers);
  }
  void put(const Program& program) {
    out_ << to_string(program.type);
    for (const Instruction& i : program.code)
      out_ << static_cast<int>(i.op) << ',' << i.operand << ' ';
    for (const Constant& c : program.constants) out_ << c.slot.i << c.text << ' ';
    out_ << '\n';
  }
  void put(const Rule& rule) {
    out_ << rule.name << static_cast<int>(rule.policies.criticality)
         << rule.policies.hold_for.count() << ' ' << rule.declaration.span.begin << '\n';
    put(rule.trigger);
    put(rule.strategies);
    put(rule.components);
    put(rule.inputs);
  }
  void put(const Strategy& s) {
    out_ << s.name << s.rule.index << ' ' << s.is_last_resort << s.within.count() << s.impact.count
         << '\n';
    put(s.when);
    put(s.components);
    for (const Adaptation& a : s.adaptations) {
      out_ << a.component.index << ' ' << static_cast<int>(a.type) << a.subject << ' '
           << a.parameter.index << a.topic << a.request << a.impact.count << '\n';
      put(a.value);
    }
  }

  std::ostringstream out_;
};

std::string all_of(const Checked& checked, const Source& source) {
  std::string out = checked.rules ? RuleSetText(*checked.rules).text() : "no rules\n";
  for (const Diagnostic& d : checked.diagnostics) {
    out +=
        std::to_string(d.span.begin) + "-" + std::to_string(d.span.end) + " " + render(d, source);
    if (d.fix) out += std::to_string(d.fix->span.begin) + " " + d.fix->text + "\n";
  }
  return out;
}

// Somebody who changes a text, and has it checked each time.
class Session {
 public:
  // The results of the check with memory, and of one without.
  std::pair<std::string, std::string> change(const std::string& text) {
    const Parsed parsed = parse_whole(Source("test.rules", text));
    if (checked_.rules) memory_.take(*checked_.rules);
    checked_ = check_again(parsed, memory_);
    return {all_of(checked_, parsed.source), all_of(check(parsed), parsed.source)};
  }

 private:
  Checked checked_;
  RuleMemory memory_;
};

RC_GTEST_PROP(RuleMemory, ChangesNothingOfWhatACheckGives, ()) {
  std::string text = random_start();
  Session session;
  for (int edits = *rc::gen::inRange(1, 12); edits > 0; --edits) {
    const auto [now, whole] = session.change(text);
    RC_ASSERT(now == whole);
    text = edited(std::move(text));
  }
}

constexpr const char* kDeclared =
    "COMPONENT camera NODE /camera LAUNCH \"run camera\"\n"
    "COMPONENT lidar NODE /lidar LAUNCH \"run lidar\"\n"
    "SIGNAL entropy DIAGNOSTIC camera KEY entropy RANGE 0..1\n";

std::string rule_of(const std::string& name, const std::string& trigger,
                    const std::string& component = "camera") {
  return "RULE " + name + "\n  POLICIES ERROR\n  TRIGGER " + trigger +
         "\n    STRATEGY s 50 10\n      ADAPTATION " + component + " redeploy 20\n";
}

// Texts that somebody has one after the other, of which each one changes what a rule that stays
// means.
TEST(RuleMemory, IsOfNoUseWhereTheNamesMeanSomethingElse) {
  const std::string a = rule_of("A", "entropy > 0.5 || mode == limit || speed > 2");
  const std::string b = rule_of("B", "age(/image) > 1s && parameter(lidar, gain) > 1", "/lidar");
  const std::string rest = a + b;
  const std::string texts[] = {
      kDeclared + rest,
      kDeclared + rest + rule_of("C", "mode == \"dock\""),
      "CONST limit = \"dock\"\n" + (kDeclared + rest),
      "CONST limit = \"other\"\n" + (kDeclared + rest),
      "CONST limit = 3\n" + (kDeclared + rest),
      kDeclared + rule_of("First", "age(/other) > 1s && limit == \"x\"", "other") + rest,
      "CYCLE 10ms\n" + (kDeclared + rest) + rule_of("C", "mode == \"dock\""),
      "SIGNAL mod TOPIC /mode FIELD data\n" + (kDeclared + rest),
      "COMPONENT laser NODE /lidar\n" + rule_of("C", "mode == \"dock\"") + rest,
      "COMPONENT zebra LAUNCH \"z\"\nCOMPONENT /lida LAUNCH \"x\"\n" + rest + "broken\n",
      rest + rest + kDeclared,
      kDeclared + rule_of("C", "mode == \"dock\" && parameter(lidar, gain) == \"x\"") + rest,
  };
  Session session;
  for (const std::string& text : texts) {
    for (const std::string& again : {text, text + "# typed", text}) {
      const auto [now, whole] = session.change(again);
      EXPECT_EQ(now, whole) << again;
    }
  }
}

}  // namespace
}  // namespace culprit
