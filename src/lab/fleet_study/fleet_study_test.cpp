#include "fleet_study/fleet_study.h"

#include <cmath>

#include <gtest/gtest.h>

#include "fleet_study/worlds.h"
#include "simulation/random.h"

namespace culprit::study::fleet {
namespace {

TEST(FleetStudy, DrawsRatesAroundTheirMean) {
  simulation::Random random(3);
  const auto next = [&] { return random.uniform(); };
  double sum = 0;
  double squares = 0;
  constexpr int kDraws = 20'000;
  for (int i = 0; i < kDraws; ++i) {
    const double rate = draw_rate(0.3, 20, next);
    ASSERT_TRUE(rate >= 0 && rate <= 1);
    sum += rate;
    squares += rate * rate;
  }
  const double mean = sum / kDraws;
  EXPECT_NEAR(mean, 0.3, 0.005);
  EXPECT_NEAR(squares / kDraws - mean * mean, 0.3 * 0.7 / 21, 0.001);
  EXPECT_EQ(draw_rate(0, 20, next), 0);
  EXPECT_EQ(draw_rate(1, 20, next), 1);
}

// Strategy 0 helps as often as the robot's rate says, strategy 1 else; the guesses say half.
class TwoStrategies : public FleetWorld {
 public:
  std::string name() const override { return "two strategies"; }
  std::vector<Belief> guesses(std::uint64_t) const override { return {{5, 5}, {4.9, 5.1}}; }
  std::unique_ptr<FleetRobot> robot(std::uint64_t model, std::uint64_t number,
                                    std::uint64_t life) const override {
    struct Robot : FleetRobot {
      explicit Robot(double its_rate, std::uint64_t seed) : rate(its_rate), luck(seed) {}
      Episode live_through(std::vector<Belief>& beliefs) override {
        const std::size_t first = beliefs[0].mean().value >= beliefs[1].mean().value ? 0 : 1;
        const std::size_t remedy = luck.chance(rate) ? 0 : 1;
        if (first == remedy) {
          beliefs[first].alpha += 1;
          return {1, 0};
        }
        beliefs[first].beta += 1;
        beliefs[remedy].alpha += 1;
        return {1, 1};
      }
      double rate;
      simulation::Random luck;
    };
    const double rate = model % 2 == 0 ? 0.95 : 0.05;
    return std::make_unique<Robot>(rate, simulation::mix(model ^ simulation::mix(number + life)));
  }
};

TEST(FleetStudy, CountsWhatANewRobotIsSpared) {
  FleetCampaign campaign;
  campaign.models = 30;
  campaign.experience = 20;
  const auto rows = study_fleet(TwoStrategies(), campaign, 2, {});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_LT(rows[0].fleet, rows[0].guesses);
  EXPECT_LE(rows[0].low, rows[0].ratio);
  EXPECT_GE(rows[0].high, rows[0].ratio);
  EXPECT_EQ(fleet_json(rows, campaign),
            fleet_json(study_fleet(TwoStrategies(), campaign, 1, {}), campaign))
      << "with any number of jobs";
}

TEST(FleetStudy, PlaysItsWorlds) {
  FleetCampaign campaign;
  campaign.models = 1;
  campaign.robots = 2;
  campaign.experience = 3;
  campaign.first = 3;
  const auto sunset = sunset_world("paper", Probabilities::kIdeal);
  ASSERT_TRUE(sunset) << sunset.error();
  const auto random = random_world(rca::Priors::kRight);
  for (const FleetWorld* world : {sunset->get(), random.get()}) {
    const auto rows = study_fleet(*world, campaign, 1, {});
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_TRUE(std::isfinite(rows[0].fleet)) << rows[0].world;
  }
  EXPECT_FALSE(sunset_world("september", Probabilities::kIdeal));
}

}  // namespace
}  // namespace culprit::study::fleet
