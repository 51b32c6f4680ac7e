#include "drill/hidden.h"

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::drill {
namespace {

using testing::IsEmpty;
using testing::UnorderedElementsAre;
using Edge = std::pair<std::string, std::string>;

Trial trial_of(const std::string& broken, const std::set<std::string>& silent, int round) {
  Trial trial{{Fault{FaultKind::kKill, broken}}, round, 100, {}, 102, 105};
  for (const std::string& each : silent) trial.silent[each] = 100.6;
  return trial;
}

// Each component is broken three times; those that need it by `edges` fall silent.
std::vector<Trial> drilled(const std::vector<std::string>& components,
                           const std::vector<Edge>& edges) {
  const Paths needs = paths_over(edges);
  std::vector<Trial> trials;
  for (int round = 1; round <= 3; ++round) {
    for (const std::string& broken : components) {
      std::set<std::string> silent;
      for (const std::string& each : components)
        if (needs.contains({each, broken})) silent.insert(each);
      trials.push_back(trial_of(broken, silent, round));
    }
  }
  return trials;
}

std::set<Edge> found_in(const std::vector<Trial>& trials, const Paths& paths = {}) {
  std::set<Edge> out;
  for (const HiddenDependency& each : hidden_dependencies(trials, paths))
    out.emplace(each.consumer, each.producer);
  return out;
}

TEST(HiddenDependencies, OfAChainAreFoundOneByOne) {
  EXPECT_THAT(found_in(drilled({"map", "planner", "driver", "camera", "viewer", "lamp"},
                               {{"planner", "map"}, {"driver", "planner"}})),
              UnorderedElementsAre(Edge("planner", "map"), Edge("driver", "planner")));
}

TEST(HiddenDependencies, OfOneComponentOnTwoAreBothFound) {
  EXPECT_THAT(found_in(drilled({"map", "radio", "driver", "camera", "viewer", "lamp"},
                               {{"driver", "map"}, {"driver", "radio"}})),
              UnorderedElementsAre(Edge("driver", "map"), Edge("driver", "radio")));
}

TEST(HiddenDependencies, OfAFeedbackLoopAreNotHiddenByIt) {
  EXPECT_THAT(found_in(drilled({"map", "planner", "driver", "camera", "viewer"},
                               {{"planner", "map"}, {"driver", "planner"}, {"planner", "driver"}}),
                       paths_over({{"driver", "planner"}, {"planner", "driver"}})),
              testing::Contains(Edge("planner", "map")));
}

TEST(HiddenDependencies, AreNoneOfAComponentThatStopsInAnyFault) {
  EXPECT_THAT(
      found_in(drilled({"a", "b", "c", "motor"}, {{"motor", "a"}, {"motor", "b"}, {"motor", "c"}})),
      IsEmpty());
}

// culprit does not know the dependency, so it blames the consumer.
TEST(HiddenDependencies, AreFoundThoughTheConsumerWasRepairedInVain) {
  std::vector<Trial> trials = drilled({"map", "planner", "camera"}, {{"planner", "map"}});
  const auto repaired_at = [&](double clock) {
    for (Trial& each : trials)
      each.events = {{{"type", "strategy_chosen"}, {"clock", clock}, {"components", {"planner"}}}};
    return found_in(trials);
  };
  EXPECT_THAT(repaired_at(101), UnorderedElementsAre(Edge("planner", "map")));
  EXPECT_THAT(repaired_at(100.5), IsEmpty()) << "the repair made it silent";
}

// A robot of ten components, of which three need another one in a way that the graph does not show.
class PlantedRobot {
 public:
  explicit PlantedRobot(unsigned seed) : random_(seed) {
    for (std::size_t c = 1; c < kComponents; ++c)
      if (below(3) > 0) visible_.push_back({name(c), name(below(c))});
    while (planted.size() < 3) {
      const std::size_t consumer = 1 + below(kComponents - 1);
      planted.emplace(name(consumer), name(below(consumer)));
      if (planted.size() == 3 && !are_all_direct()) planted.clear();
    }
  }

  // Five rounds of two faults for each. One in fifty other components stutters meanwhile.
  std::vector<Trial> drill() {
    const Paths needs = paths_over(all_edges());
    std::vector<Trial> trials;
    for (int round = 1; round <= 5; ++round) {
      for (const FaultKind kind : {FaultKind::kKill, FaultKind::kHang}) {
        for (std::size_t broken = 0; broken < kComponents; ++broken) {
          std::set<std::string> silent;
          for (std::size_t c = 0; c < kComponents; ++c)
            if (needs.contains({name(c), name(broken)}) || below(50) == 0) silent.insert(name(c));
          trials.push_back(trial_of(name(broken), silent, round));
          trials.back().faults.front().kind = kind;
        }
      }
    }
    return trials;
  }
  Paths shown() const { return paths_over(visible_); }

  std::set<Edge> planted;

 private:
  static constexpr std::size_t kComponents = 10;
  static std::string name(std::size_t number) { return "c" + std::to_string(number); }
  std::size_t below(std::size_t end) { return random_() % end; }

  std::vector<Edge> all_edges() const {
    std::vector<Edge> edges = visible_;
    edges.insert(edges.end(), planted.begin(), planted.end());
    return edges;
  }
  // None follows from the others and the graph.
  bool are_all_direct() const {
    return std::ranges::none_of(planted, [&](const Edge& each) {
      std::vector<Edge> others = all_edges();
      std::erase(others, each);
      return std::ranges::find(visible_, each) != visible_.end() ||
             paths_over(others).contains(each);
    });
  }

  std::mt19937_64 random_;
  std::vector<Edge> visible_;
};

TEST(HiddenDependencies, ThatArePlantedAreFoundInTwentyDrillsAndNoneIsFalse) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    PlantedRobot robot(seed);
    EXPECT_EQ(found_in(robot.drill(), robot.shown()), robot.planted) << "seed " << seed;
  }
}

}  // namespace
}  // namespace culprit::drill
