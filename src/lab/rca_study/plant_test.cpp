#include "rca_study/plant.h"

#include <gtest/gtest.h>

namespace culprit::study::rca {
namespace {

using namespace std::chrono_literals;

// Components in a row, each passing on to the next after a second.
RcaScenario chain(std::size_t size) {
  RcaScenario scenario;
  for (std::size_t i = 0; i < size; ++i) {
    scenario.components.push_back({"c" + std::to_string(i), Criticality::kError, {}, {}});
    scenario.topics.push_back({"/c" + std::to_string(i), {i}, {}});
    if (i > 0) scenario.topics[i - 1].subscribers.push_back({i, 1, 1, false});
  }
  return scenario;
}

void run(Plant& plant, Duration until) {
  while (plant.step(Time(until))) continue;
}

std::string ill(const Plant& plant, std::size_t size) {
  std::string all;
  for (std::size_t c = 0; c < size; ++c) all += plant.is_ill(c) ? '!' : '.';
  return all;
}

TEST(Plant, PassesIllnessOnAndRecoversAsLate) {
  RcaScenario scenario = chain(3);
  scenario.faults = {{0, FaultKind::kSilent, 1}};
  Plant plant(scenario);
  run(plant, 2500ms);
  EXPECT_EQ(ill(plant, 3), "!!.");
  run(plant, 5s);
  EXPECT_EQ(ill(plant, 3), "!!!");
  EXPECT_TRUE(plant.passes(0, 2));
  EXPECT_FALSE(plant.passes(2, 0));
  plant.repair(0);
  EXPECT_EQ(ill(plant, 3), ".!!");
  run(plant, 6500ms);
  EXPECT_EQ(ill(plant, 3), "..!");
  run(plant, 8s);
  EXPECT_TRUE(plant.is_well());
}

TEST(Plant, NeverHearsOfWhatIsOverBeforeItArrives) {
  const RcaScenario scenario = chain(3);
  Plant plant(scenario);
  plant.set_down(0, true);
  run(plant, 1500ms);
  plant.set_down(0, false);
  run(plant, 2s);
  EXPECT_EQ(ill(plant, 3), ".!.");
  run(plant, 9s);
  EXPECT_TRUE(plant.is_well());
}

TEST(Plant, KeepsNoCircleIllByItself) {
  RcaScenario scenario = chain(3);
  scenario.topics[2].subscribers.push_back({0, 1, 1, false});
  scenario.faults = {{1, FaultKind::kSilent, 1}};
  Plant plant(scenario);
  run(plant, 9s);
  EXPECT_EQ(ill(plant, 3), "!!!");
  plant.repair(1);
  run(plant, 20s);
  EXPECT_TRUE(plant.is_well());
}

TEST(Plant, NeedsAllRedundantSourcesToFail) {
  RcaScenario scenario = chain(2);
  scenario.components.push_back({"c2", Criticality::kError, {}, {}});
  scenario.topics[0].subscribers = {{2, 1, 1, true}};
  scenario.topics[1].subscribers = {{2, 1, 1, true}};
  scenario.faults = {{0, FaultKind::kSilent, 1}, {1, FaultKind::kSilent, 5}};
  Plant plant(scenario);
  run(plant, 4s);
  EXPECT_EQ(ill(plant, 3), "!..");
  run(plant, 7s);
  EXPECT_EQ(ill(plant, 3), "!!!");
}

TEST(Plant, FlapsUntilRepaired) {
  RcaScenario scenario = chain(1);
  scenario.faults = {{0, FaultKind::kFlapping, 1}};
  Plant plant(scenario);
  run(plant, 2s);
  EXPECT_TRUE(plant.is_ill(0));
  run(plant, 5s);
  EXPECT_FALSE(plant.is_ill(0));
  EXPECT_FALSE(plant.is_well());
  run(plant, 6s);
  EXPECT_TRUE(plant.is_ill(0));
  plant.repair(0);
  run(plant, 30s);
  EXPECT_TRUE(plant.is_well());
}

}  // namespace
}  // namespace culprit::study::rca
