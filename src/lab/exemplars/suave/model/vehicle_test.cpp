#include "exemplars/suave/model/vehicle.h"

#include <gtest/gtest.h>

namespace culprit::suave::model {
namespace {

Vehicle at_origin() { return Vehicle({}, {0, 0, -18}, simulation::Random(1)); }

// Seconds until it is half a metre from `goal`.
double time_to(Vehicle& vehicle, const Position& goal) {
  vehicle.go_to(goal);
  double time = 0;
  while (!is_near(vehicle.position(), goal, 0.5) && time < 1000) {
    vehicle.advance();
    time += std::chrono::duration<double>(Vehicle::kStep).count();
  }
  return time;
}

TEST(Vehicle, CruisesAndArrives) {
  Vehicle vehicle = at_origin();
  const VehicleTraits traits;
  const double time = time_to(vehicle, {30, 0, -18});
  EXPECT_GT(time, 29.5 / traits.cruise);
  EXPECT_LT(time, 29.5 / traits.cruise + 5);
}

TEST(Vehicle, IsSlowerWithEachFailedThrusterAndWellAfterARecovery) {
  Vehicle well = at_origin();
  Vehicle one = at_origin();
  one.set_failed(1, true);
  Vehicle two = at_origin();
  two.set_failed(1, true);
  two.set_failed(3, true);
  const double time = time_to(well, {30, 0, -18});
  const double time_of_one = time_to(one, {30, 0, -18});
  EXPECT_GT(time_of_one, 2 * time);
  EXPECT_GT(time_to(two, {30, 0, -18}), 1.4 * time_of_one);
  one.set_failed(1, false);
  EXPECT_EQ(one.failed_thrusters(), 0);
  EXPECT_NEAR(time_to(one, {0, 0, -18}), time, 1);
}

TEST(Vehicle, StaysWhereItIsWithoutPower) {
  Vehicle vehicle = at_origin();
  vehicle.cut_power();
  EXPECT_GE(time_to(vehicle, {30, 0, -18}), 1000);
  EXPECT_EQ(vehicle.position().x, 0);
}

TEST(Vehicle, SeesItsPositionWithTheNoiseThatItIsGiven) {
  Vehicle vehicle = at_origin();
  const VehicleTraits traits;
  double squares = 0;
  constexpr int kSteps = 200'000;
  for (int step = 0; step < kSteps; ++step) {
    vehicle.advance();
    const double off = vehicle.seen().y - vehicle.position().y;
    squares += off * off;
  }
  EXPECT_NEAR(std::sqrt(squares / kSteps), traits.drift_sd, 0.1 * traits.drift_sd);
}

}  // namespace
}  // namespace culprit::suave::model
