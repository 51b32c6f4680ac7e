#include "language/facts.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/checker.h"
#include "language/evaluate.h"

namespace culprit {
namespace {

constexpr const char* kSignals =
    "SIGNAL x TOPIC /x FIELD data RANGE 0..1\n"
    "SIGNAL y TOPIC /y FIELD data RANGE -3..2\n";

std::string rule(const std::string& trigger) {
  return kSignals + ("RULE r\n  POLICIES ERROR\n  TRIGGER " + trigger +
                     "\n    STRATEGY s 50 10\n      ADAPTATION c restart 5\n");
}

// The findings about the trigger: "never: <text>" or "always: <text>", in the order of the text.
std::vector<std::string> said_about(const std::string& trigger) {
  const Source source("test.rules", rule(trigger));
  const Checked checked = check(source);
  EXPECT_TRUE(checked.rules) << trigger;
  std::vector<std::string> said;
  for (const Diagnostic& d : checked.diagnostics) {
    const std::string text(source.text(d.span));
    if (d.code == Code::kNeverTrueInRange) said.push_back("never: " + text);
    if (d.code == Code::kAlwaysTrueInRange) said.push_back("always: " + text);
  }
  return said;
}

using Said = std::vector<std::string>;

TEST(Facts, KnowWhatCannotBe) {
  for (const char* never : {"x > 2",
                            "x >= 1.5",
                            "x < 0",
                            "2 < x",
                            "x == 7",
                            "y < -3",
                            "x * 2 > 2.5",
                            "x + y > 4.5",
                            "abs(y) > 3",
                            "min(x, y) > 1",
                            "max(x, y) < 0",
                            "-x > 0",
                            "x / 2 > 1",
                            "rate(/t) < 0",
                            "age(/t) < 0s",
                            "phi(/t) < 0",
                            "stddev(x, 2s) < 0",
                            "stddev(x, 2s) > 1.5",
                            "mean(x, 2s) > 1.1",
                            "max(x, 2s) > 1",
                            "level(d) > 3",
                            "level(d) < 0",
                            "level(d) == 4",
                            "lifecycle(c) == \"Active\"",
                            "(x > 0.5 ? x : 0 - x) > 1"})
    EXPECT_EQ(said_about(never), Said{std::string("never: ") + never});
  for (const char* always :
       {"x < 5", "x <= 1", "x >= 0", "x != 2", "rate(/t) >= 0", "age(/t) >= 0s", "level(d) <= 3",
        "lifecycle(c) != \"dead\"", "sqrt(y) >= 0"})
    EXPECT_EQ(said_about(always), Said{std::string("always: ") + always});
}

TEST(Facts, KnowWhatCannotBeTogether) {
  for (const char* never :
       {"x > 0.8 && x < 0.2", "z > 0.8 && z < 0.2", "z > 1 && !(z > 0)", "z == 1 && z == 2",
        "z == 1 && z != 1", "z > 5 && z <= 5", "(z < 1 || z > 3) && z == 2",
        "lifecycle(c) == \"active\" && lifecycle(c) == \"inactive\"", "alive(c) && !alive(c)",
        "alive(c) == true && alive(c) == false", "level(d) > 1 && level(d) < 2",
        "age(/t) > 2s && age(/t) < 500ms", "z > 1 && w > z && w < 1"})
    EXPECT_EQ(said_about(never), Said{std::string("never: ") + never});
  EXPECT_EQ(said_about("z > 1 || z <= 1"), Said{"always: z > 1 || z <= 1"});
}

TEST(Facts, PointAtThePartThatIsToBlame) {
  EXPECT_EQ(said_about("z > 1 && x > 2"), Said{"never: x > 2"});
  EXPECT_EQ(said_about("z > 1 || !(x < 5)"), Said{"always: (x < 5)"});
  EXPECT_EQ(said_about("z > 1 || (w > 3 && w < 2)"), Said{"never: (w > 3 && w < 2)"});
  EXPECT_EQ(said_about("x > 2 || x < 5"), (Said{"never: x > 2", "always: x < 5"}));
}

TEST(Facts, SayNothingWithoutBeingCertain) {
  for (const char* possible :
       {"x > 0.9", "x >= 1", "x <= 0", "x == 0.5", "z > 1e300", "y / x > 100", "x - x > 0.5",
        "mean(x, 2s) > 1", "level(d) > 2", "rate(/t) <= 0", "z > 0.2 && z < 0.8",
        "z > 0.8 || z < 0.2", "z % 2 == 1", "pow(x, 2) > 2", "lifecycle(c) == \"in transition\"",
        "lifecycle(c) != lifecycle(e)", "z > 1 && w > z && z > w",
        "9007199254740993 > 9007199254740992 && "
        "z > 1",
        "age(/t) > 100000h"})
    EXPECT_EQ(said_about(possible), Said{}) << possible;
}

// Random conditions over inputs of known values.
rc::Gen<std::string> condition(int depth) {
  const auto number = rc::gen::element<std::string>(
      "x", "y", "rate(/t)", "0.5", "1", "-1.5", "3", "x + y", "y * 2", "abs(y)", "min(x, y)",
      "y / x", "x / y", "-x", "x * rate(/t)", "(x > 0.5 ? y : 2)", "max(y, 0.25)", "sqrt(y)",
      "level(d)", "level(d) / 2", "level(d) % 2");
  const auto order = rc::gen::element<std::string>("<", "<=", ">", ">=", "==", "!=");
  const auto comparison =
      rc::gen::apply([](const std::string& a, const std::string& op,
                        const std::string& b) { return "(" + a + " " + op + " " + b + ")"; },
                     number, order, number);
  if (depth == 0) return comparison;
  const auto binary = rc::gen::apply(
      [](const std::string& a, const std::string& op, const std::string& b) {
        return "(" + a + " " + op + " " + b + ")";
      },
      condition(depth - 1), rc::gen::element<std::string>("&&", "||"), condition(depth - 1));
  const auto negated =
      rc::gen::map(condition(depth - 1), [](const std::string& a) { return "!" + a; });
  const auto chosen =
      rc::gen::apply([](const std::string& a, const std::string& b,
                        const std::string& c) { return "(" + a + " ? " + b + " : " + c + ")"; },
                     condition(depth - 1), condition(depth - 1), condition(depth - 1));
  return rc::gen::weightedOneOf<std::string>(
      {{3, comparison}, {4, binary}, {2, negated}, {1, chosen}});
}

Slot value_of(const Input& input, const RuleSet& rules) {
  const int step = *rc::gen::inRange(0, 5);  // the ends of the range are the likeliest mistakes
  switch (input.kind) {
    case Input::Kind::kSignal: {
      const auto range = *rules[input.signal].range;
      return Slot::of(range.low + (range.high - range.low) * step / 4);
    }
    case Input::Kind::kRate:
      return Slot::of(static_cast<double>(step) * 0.75);
    default:
      return Slot::of(static_cast<std::int64_t>(step % 4));
  }
}

void expect_evaluation_to_agree(const std::string& trigger) {
  const Source source("test.rules", rule(trigger));
  const Checked whole = check(source);
  if (!whole.rules) return;  // a trigger of constants is an error of its own
  for (const Diagnostic& d : whole.diagnostics) {
    RC_ASSERT(d.code == Code::kNeverTrueInRange || d.code == Code::kAlwaysTrueInRange);
    const std::string text(source.text(d.span));
    const Checked part = check(Source("part.rules", rule(text)));
    RC_ASSERT(part.rules.has_value());
    for (int i = 0; i < 50; ++i) {
      std::vector<Slot> inputs;
      for (const Input& input : part.rules->inputs) inputs.push_back(value_of(input, *part.rules));
      const Slot result = evaluate(part.rules->rules[0].trigger, inputs);
      if (result.known && result.b != (d.code == Code::kAlwaysTrueInRange))
        RC_FAIL(to_string(d.code) + " is said of " + text);
    }
  }
}

// Most conditions are neither always nor never true, so it takes many.
RC_GTEST_PROP(Facts, AreNeverMistaken, ()) {
  for (int i = 0; i < 30; ++i) expect_evaluation_to_agree(*condition(i % 3));
}

}  // namespace
}  // namespace culprit
