#include "knowledge/knowledge.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

// Each telling is a row of the journal.
TEST(Knowledge, TellsWhatIsIntendedOnlyWhenThatIsNew) {
  const RuleSet rules = *check(Source("x.rules",
                                      "RULE R\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 50 10\n"
                                      "ADAPTATION c activate 1\n"))
                             .rules;
  Knowledge knowledge(rules);
  for (const Lifecycle state : {Lifecycle::kActive, Lifecycle::kActive, Lifecycle::kInactive})
    knowledge.components.intend_lifecycle(ComponentId(0), state, Time(1s), knowledge.events);
  ASSERT_EQ(knowledge.events.size(), 2u);
  EXPECT_EQ(std::get<LifecycleIntended>(knowledge.events[0].what).state, Lifecycle::kActive);
  EXPECT_EQ(std::get<LifecycleIntended>(knowledge.events[1].what).state, Lifecycle::kInactive);
}

// One after the other, as can_hear_from() says it of several.
Time can_hear_from(const Knowledge& knowledge, ComponentId component) {
  if (!knowledge.graph.reads_others(component)) return kLongAgo;
  const auto has_ends = [](const ComponentState& state) {
    return std::max({state.node_seen, state.ends_back, state.awaits_ends_until});
  };
  Time from = has_ends(knowledge.components[component]);
  for (const ComponentId upstream : knowledge.graph.upstream(component)) {
    if (knowledge.components[upstream].alive == false) return kNever;
    from = std::max(from, has_ends(knowledge.components[upstream]));
  }
  return later(from, knowledge.finding);
}

// With loops, and with components that are not there: each is missed by the others only.
RC_GTEST_PROP(Knowledge, SeveralCanHearWhenTheLastOfThemCan, ()) {
  const int size = *rc::gen::inRange(1, 8);
  std::string text;
  const auto name = [](int c) { return "c" + std::to_string(c); };
  for (int c = 0; c < size; ++c) text += "COMPONENT " + name(c) + " NODE /" + name(c) + "\n";
  const RuleSet rules = check(Source("x.rules", text)).rules.value();
  Knowledge knowledge(rules);
  const auto any_node = [&] { return "/" + name(*rc::gen::inRange(0, size)); };
  for (int links = *rc::gen::inRange(0, 2 * size); links > 0; --links) {
    const std::string topic = "/t" + std::to_string(links);
    knowledge.graph.endpoint_appeared(any_node(), EndpointKind::kPublisher, topic);
    knowledge.graph.endpoint_appeared(any_node(), EndpointKind::kSubscriber, topic);
  }
  knowledge.finding = 3s;
  std::vector<ComponentId> asked;
  Time last = kLongAgo;
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    ComponentState& state = knowledge.components[ComponentId(c)];
    state.node_seen = Time(std::chrono::seconds(*rc::gen::inRange(0, 100)));
    if (*rc::gen::weightedElement<int>({{4, 0}, {1, 1}}) == 1) state.alive = false;
    if (*rc::gen::arbitrary<bool>()) asked.emplace_back(c);
  }
  for (const ComponentId c : asked) last = std::max(last, can_hear_from(knowledge, c));
  RC_ASSERT(knowledge.can_hear_from(asked) == last);
}

}  // namespace
}  // namespace culprit
