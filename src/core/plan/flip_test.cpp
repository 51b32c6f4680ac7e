#include "plan/flip.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/checker.h"
#include "plan/decision.h"
#include "plan/paper_planner.h"

namespace culprit::plan {
namespace {

const PaperPlanner kPlanner;

// A robot with failures, and what is decided about them.
class Situation {
 public:
  explicit Situation(const std::string& rules)
      : rules_(*check(Source("test.rules", rules)).rules), knowledge_(rules_) {
    for (std::size_t c = 0; c < rules_.components.size(); ++c) {
      knowledge_.components[ComponentId(c)].alive = true;
      knowledge_.components[ComponentId(c)].lifecycle = Lifecycle::kActive;
      knowledge_.graph.node_appeared(rules_.components[c].node);
    }
  }

  RuleSet& rules() { return rules_; }
  Knowledge& knowledge() { return knowledge_; }

  void link(std::size_t producer, std::size_t consumer) {
    const std::string topic = "/t" + std::to_string(producer);
    knowledge_.graph.endpoint_appeared(rules_.components[producer].node, EndpointKind::kPublisher,
                                       topic);
    knowledge_.graph.endpoint_appeared(rules_.components[consumer].node, EndpointKind::kSubscriber,
                                       topic);
  }
  void fails(std::size_t rule) { knowledge_.states.enter(RuleId(rule), RulePhase::kFailing); }

  std::vector<RuleId> failures() const {
    std::vector<RuleId> failures;
    for (const RuleId id : knowledge_.states.active()) {
      if (knowledge_.states[id].phase == RulePhase::kFailing) failures.push_back(id);
    }
    return failures;
  }
  std::vector<ExplainedDecision> decide() const {
    return plan::decide(kPlanner, failures(), knowledge_);
  }
  bool is_chosen(StrategyId strategy) const {
    for (const Decision& decision : kPlanner.plan(failures(), knowledge_)) {
      if (decision.chosen == strategy) return true;
    }
    return false;
  }
  StrategyId strategy(const std::string& name) const {
    for (std::size_t s = 0; s < rules_.strategies.size(); ++s) {
      if (rules_.strategies[s].name == name) return StrategyId(s);
    }
    throw std::logic_error("no such strategy");
  }
  // The changes with which the strategy would win, in words, one line each.
  std::string flips(const std::string& name) const {
    std::string out;
    FlipFinder finder(kPlanner, failures(), knowledge_);
    for (const Change& change : finder.flips(strategy(name)))
      out += describe(change, strategy(name), knowledge_) + "\n";
    return out;
  }

  // The same changes as WhatIf makes, made to the original.
  void make(const SuccessChange& c) {
    const Belief before = knowledge_.beliefs[c.strategy];
    const double weight = before.alpha + before.beta;
    knowledge_.beliefs.set(c.strategy, {weight * c.success.value, weight * (1 - c.success.value)});
  }
  void make(const ImpactChange& c) {
    rules_.strategies[c.strategy.index].impact = c.impact;
    rules_.heaviest = {0};
    for (const Strategy& s : rules_.strategies)
      rules_.heaviest = std::max(rules_.heaviest, s.impact);
  }
  void make(const TriedChange& c) { knowledge_.states.set_tried(c.strategy, c.is_tried); }
  void make(const ResolvedChange& c) {
    for (const RuleId rule : c.rules) knowledge_.states.enter(rule, RulePhase::kQuiet);
  }
  void make(const ComponentChange& c) {
    using enum ComponentChange::Situation;
    ComponentState& state = knowledge_.components[c.component];
    if (c.situation == kLaunchable) {
      rules_.components[c.component.index].launch = {"x"};
      return;
    }
    state.alive = c.situation != kAbsent;
    if (c.situation == kActive) state.lifecycle = Lifecycle::kActive;
    if (c.situation == kInactive) state.lifecycle = Lifecycle::kInactive;
  }
  void make(const WhenChange& c) { rules_.strategies[c.strategy.index].when = Program(); }

 private:
  RuleSet rules_;
  Knowledge knowledge_;
};

constexpr const char* kTwoRules = R"(
COMPONENT a NODE /a LAUNCH "a"
COMPONENT b NODE /b LAUNCH "b"
COMPONENT c NODE /c
SIGNAL dark DIAGNOSTIC a KEY dark
RULE A
  POLICIES ERROR
  TRIGGER x > 1
    STRATEGY a_restart 60 10
      ADAPTATION a restart 4
    STRATEGY a_redeploy 90 10
      ADAPTATION a redeploy 10
    STRATEGY a_light 90 10 WHEN dark
      ADAPTATION a set_parameter light true 1
RULE B
  POLICIES ERROR
  TRIGGER x > 1
    STRATEGY b_restart 60 10
      ADAPTATION b restart 4
    STRATEGY b_activate 60 10
      ADAPTATION b activate 3
)";

TEST(Flips, OfACostlierStrategy) {
  Situation s(kTwoRules);
  s.fails(0);
  EXPECT_TRUE(s.is_chosen(s.strategy("a_restart")));
  EXPECT_EQ(s.flips("a_redeploy"),
            "a_restart's success probability were at most 30 % (is 60 %)\n"
            "its impact were at most 5 cycles (is 10)\n"
            "a_restart had been tried already\n");
}

TEST(Flips, OfWhatWasTriedAlready) {
  Situation s(kTwoRules);
  s.fails(0);
  s.knowledge().states.set_tried(s.strategy("a_restart"), true);
  EXPECT_EQ(s.flips("a_restart"), "it had not been tried already\n");
}

TEST(Flips, OfWhatMakesNoSense) {
  Situation s(kTwoRules);
  s.fails(0);
  EXPECT_EQ(s.flips("a_light"), "its WHEN condition were true\n");
  s.knowledge().components[ComponentId(0)].alive = false;
  s.knowledge().components[ComponentId(0)].lifecycle = Lifecycle::kUnknown;
  EXPECT_EQ(s.flips("a_restart"), "a were alive and active\na were alive and inactive\n");
  s.fails(1);
  EXPECT_EQ(s.flips("b_activate"), "b were alive and inactive\n");
}

TEST(Flips, OfWhatDependsOnAPossibleCause) {
  Situation s(kTwoRules);
  s.link(0, 1);
  s.fails(0);
  s.fails(1);
  EXPECT_FALSE(s.is_chosen(s.strategy("b_restart")));
  EXPECT_EQ(s.flips("b_restart"), "A were resolved\n");
  EXPECT_EQ(s.decide()[0].explains, std::vector<RuleId>{RuleId(1)});
}

TEST(Flips, NameAllFailuresThatAreInTheWay) {
  std::string rules = "COMPONENT last NODE /last\n";
  for (const char* name : {"p", "q", "r"})
    rules += std::string("COMPONENT ") + name + " NODE /" + name + "\nRULE " + name +
             "_bad\n  POLICIES ERROR\n  TRIGGER x > 1\n    STRATEGY " + name +
             "_restart 60 10\n      ADAPTATION " + name + " restart 2\n";
  rules +=
      "RULE last_bad\n  POLICIES ERROR\n  TRIGGER x > 1\n    STRATEGY last_restart 60 10\n"
      "      ADAPTATION last restart 2\n";
  Situation s(rules);
  for (std::size_t c = 1; c <= 3; ++c) s.link(c, 0);
  for (const std::size_t rule : {0, 2, 3}) s.fails(rule);
  EXPECT_EQ(s.flips("last_restart"), "p_bad and r_bad were resolved\n");
}

// The last rule waits for the first one and, as long as the third is there, for the second.
class Queue final : public Planner {
 public:
  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override {
    const auto is_there = [&](std::size_t rule) {
      return std::find(failures.begin(), failures.end(), RuleId(rule)) != failures.end();
    };
    const RuleId last = failures.back();
    Decision decision;
    decision.rule = last;
    Candidate candidate;
    candidate.strategy = knowledge.rules[last].strategies.front();
    if (is_there(0)) candidate.failure = RuleId(0);
    if (!is_there(0) && is_there(2)) candidate.failure = RuleId(is_there(1) ? 1 : 2);
    if (candidate.failure) {
      candidate.excluded = Condition::kDependency;
    } else {
      decision.chosen = candidate.strategy;
    }
    decision.candidates = {candidate};
    return {decision};
  }
};

TEST(Flips, NameNoFailureThatIsInTheWayBecauseOfAnotherOneOnly) {
  std::string rules = "COMPONENT c NODE /c\n";
  for (const char* name : {"p", "q", "r", "last"})
    rules += std::string("RULE ") + name + "\n  POLICIES ERROR\n  TRIGGER x > 1\n    STRATEGY " +
             name + "_restart 60 10\n      ADAPTATION c restart 2\n";
  Situation s(rules);
  for (std::size_t rule = 0; rule < 4; ++rule) s.fails(rule);
  const Queue planner;
  FlipFinder finder(planner, s.failures(), s.knowledge());
  const auto flips = finder.flips(s.strategy("last_restart"));
  const auto resolved = std::find_if(flips.begin(), flips.end(), [](const Change& change) {
    return std::holds_alternative<ResolvedChange>(change);
  });
  ASSERT_NE(resolved, flips.end());
  EXPECT_EQ(std::get<ResolvedChange>(*resolved).rules, (std::vector{RuleId(0), RuleId(2)}));
}

TEST(Flips, OfWhatIsUnderRepair) {
  Situation s(std::string(kTwoRules) +
              "RULE Slow\n  POLICIES WARNING\n  TRIGGER x > 2\n    STRATEGY hurry 80 10\n"
              "      ADAPTATION a set_parameter fast true 1\n");
  s.fails(0);
  s.fails(2);
  EXPECT_EQ(s.flips("hurry"), "A were resolved\n") << "it would take what A's strategy takes";
  RuleState& state = s.knowledge().states.state(RuleId(0));
  state.attempt.emplace();
  state.attempt->strategy = s.strategy("a_restart");
  s.knowledge().states.enter(RuleId(0), RulePhase::kAttempting);
  EXPECT_EQ(s.flips("hurry"), "A were resolved\n");
}

TEST(Flips, OfWhatAnotherRulesStrategyTakes) {
  Situation s(std::string(kTwoRules) +
              "RULE C\n  POLICIES ERROR\n  TRIGGER x > 2\n    STRATEGY hurry 40 10\n"
              "      ADAPTATION a set_parameter fast true 4\n");
  s.fails(0);
  s.fails(2);
  EXPECT_EQ(s.flips("hurry"),
            "its success probability were at least 60.1 % (is 40 %)\n"
            "A.a_restart's success probability were at most 39.9 % (is 60 %)\n"
            "its impact were at most 1 cycle (is 4)\n"
            "A were resolved\n"
            "A.a_restart had been tried already\n");
}

// ---- for any robot

std::string random_rules(std::size_t components, std::size_t rules) {
  std::string text = "SIGNAL dark DIAGNOSTIC d KEY dark\n";
  for (std::size_t c = 0; c < components; ++c) {
    text += "COMPONENT c" + std::to_string(c) + " NODE /c" + std::to_string(c);
    text += *rc::gen::inRange(0, 5) == 0 ? "\n" : " LAUNCH \"c\"\n";
  }
  const auto one_of = [](const std::vector<std::string>& words) {
    return *rc::gen::elementOf(words);
  };
  for (std::size_t r = 0; r < rules; ++r) {
    text += "RULE r" + std::to_string(r) + "\n  POLICIES " +
            one_of({"ERROR", "WARNING", "NON_CRITICAL"}) + "\n  TRIGGER x > 1\n";
    const int strategies = *rc::gen::inRange(1, 4);
    for (int s = 0; s < strategies; ++s) {
      text += "    STRATEGY r" + std::to_string(r) + "s" + std::to_string(s) + " " +
              std::to_string(*rc::gen::inRange(1, 101)) + " " +
              std::to_string(*rc::gen::inRange(1, 50)) +
              (*rc::gen::inRange(0, 8) == 0 ? " WHEN dark\n" : "\n");
      text += "      ADAPTATION c" + std::to_string(*rc::gen::inRange<std::size_t>(0, components)) +
              " " + one_of({"restart", "activate", "deactivate", "set_parameter p 1"}) + " " +
              std::to_string(*rc::gen::inRange(1, 30)) + "\n";
    }
  }
  return text;
}

std::unique_ptr<Situation> random_situation() {
  const auto components = *rc::gen::inRange<std::size_t>(1, 6);
  const auto rules = *rc::gen::inRange<std::size_t>(1, 6);
  auto s = std::make_unique<Situation>(random_rules(components, rules));
  const auto chance = [](int of) { return *rc::gen::inRange(0, of) == 0; };
  for (std::size_t c = 0; c < components; ++c) {
    ComponentState& state = s->knowledge().components[ComponentId(c)];
    if (chance(4)) state.lifecycle = Lifecycle::kInactive;
    if (chance(6)) {
      state.alive = false;
      state.lifecycle = Lifecycle::kUnknown;
    }
    for (std::size_t other = 0; other < c; ++other) {
      if (chance(2)) s->link(other, c);
    }
  }
  for (std::size_t r = 0; r < rules; ++r) {
    if (chance(4)) continue;
    s->fails(r);
    for (const StrategyId id : s->rules().rules[r].strategies) {
      if (chance(5)) s->knowledge().states.set_tried(id, true);
    }
  }
  return s;
}

std::string summary(const std::vector<ExplainedDecision>& decisions) {
  std::string out;
  for (const ExplainedDecision& d : decisions) {
    out += std::to_string(d.decision.rule.index) + ":" +
           (d.decision.chosen ? std::to_string(d.decision.chosen->index) : "-") + " ";
  }
  return out;
}

// A little less of the change, where there is less of it; empty: less is none.
std::optional<Change> a_step_less(const Change& change, const Knowledge& knowledge) {
  if (const auto* success = std::get_if<SuccessChange>(&change)) {
    const double now = knowledge.beliefs[success->strategy].mean().value;
    const double step = success->success.value > now ? -0.001 : 0.001;
    return SuccessChange{success->strategy, {success->success.value + step}};
  }
  if (const auto* impact = std::get_if<ImpactChange>(&change))
    return ImpactChange{impact->strategy, {impact->impact.count + 1}};
  return std::nullopt;
}

RC_GTEST_PROP(Flips, FlipTheDecision, ()) {
  const auto s = random_situation();
  const auto decisions = s->decide();
  for (const ExplainedDecision& explained : decisions) {
    for (std::size_t i = 0; i < explained.flips.size(); ++i) {
      const StrategyId loser = explained.decision.candidates[i].strategy;
      for (const Change& change : explained.flips[i]) {
        WhatIf less(s->knowledge());
        if (const auto step = a_step_less(change, s->knowledge())) {
          less.assume(*step);
          for (const Decision& v : kPlanner.plan(s->failures(), less.knowledge()))
            RC_ASSERT(v.chosen != loser);
        }
      }
    }
  }
  // Made to the robot itself, one of them each time.
  std::vector<std::pair<StrategyId, Change>> all;
  for (const ExplainedDecision& explained : decisions) {
    for (std::size_t i = 0; i < explained.flips.size(); ++i) {
      for (const Change& change : explained.flips[i])
        all.emplace_back(explained.decision.candidates[i].strategy, change);
    }
  }
  RC_CLASSIFY(!all.empty(), "with flips");
  if (all.empty()) return;
  const auto& [loser, change] = all[*rc::gen::inRange<std::size_t>(0, all.size())];
  RC_ASSERT(!s->is_chosen(loser));
  std::visit([&](const auto& what) { s->make(what); }, change);
  RC_ASSERT(s->is_chosen(loser));
}

RC_GTEST_PROP(Flips, LeaveWhatIsKnownAsItIs, ()) {
  const auto s = random_situation();
  const std::string before = summary(s->decide());
  RC_ASSERT(summary(s->decide()) == before);
  // The finder takes back its assumptions: asked twice, it gives the same answer.
  FlipFinder finder(kPlanner, s->failures(), s->knowledge());
  for (const Decision& decision : finder.decisions()) {
    for (const Candidate& candidate : decision.candidates) {
      if (decision.chosen == candidate.strategy) continue;
      const auto words = [&] {
        std::string out;
        for (const Change& change : finder.flips(candidate.strategy))
          out += describe(change, candidate.strategy, s->knowledge()) + "\n";
        return out;
      };
      const std::string first = words();
      RC_ASSERT(words() == first);
    }
  }
}

}  // namespace
}  // namespace culprit::plan
