// The value of a fleet's prior for a new robot: how many strategies fail in its first failures,
// compared with a robot of the same kind that begins with the rule file's guesses.
//
// Robots of one model differ: each has rates of its own, drawn around those of its model. Some have
// been at work; what they counted is pooled (knowledge/pooled_prior.h) for one that has not. A robot
// that differs is like those of another model, which it is not told. A veteran begins with what it
// learned itself in as long a time as one of the others, and shows what there is to be gained.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "knowledge/beliefs.h"
#include "knowledge/pooled_prior.h"

namespace culprit::study::fleet {

// The result of one episode.
struct Episode {
  int failures = 0;  // detected
  int failed = 0;    // strategies that did not help
};

// One robot, over and over.
class FleetRobot {
 public:
  virtual ~FleetRobot() = default;
  // Breaks it once and lets culprit heal it, beginning with these beliefs (by strategy), which go on.
  virtual Episode live_through(std::vector<Belief>& beliefs) = 0;
};

// A kind of robots.
class FleetWorld {
 public:
  virtual ~FleetWorld() = default;
  virtual std::string name() const = 0;
  // The rule file's guesses for this model. All models have the same strategies.
  virtual std::vector<Belief> guesses(std::uint64_t model) const = 0;
  // Robot `number` of that model. The same numbers give the same robot with the same luck; `life`
  // gives it other luck.
  virtual std::unique_ptr<FleetRobot> robot(std::uint64_t model, std::uint64_t number,
                                            std::uint64_t life) const = 0;
};

struct FleetCampaign {
  std::uint32_t models = 40;
  std::uint32_t robots = 20;      // of each model, at work before
  std::uint32_t experience = 50;  // episodes that each of them had
  std::uint32_t first = 50;       // failures of the new robot
  Pooling pooling{};
  std::uint64_t seed = 1;
};

// Failed strategies in the first failures: the mean of all models.
struct FleetRow {
  std::string world;
  bool differs = false;  // the new robot
  double guesses = 0;    // it begins with those of the rule file
  double fleet = 0;      // with the fleet's prior
  double veteran = 0;    // with what it learned itself
  // fleet / guesses, and 95 % of it by bootstrap over models.
  double ratio = 0;
  double low = 0;
  double high = 0;
};

// Two rows: of robots that are like the others, and of robots that differ. Depends on nothing but
// the campaign. `told` is asked after each model whether to go on (null: yes); nothing is given
// where it said no.
std::vector<FleetRow> study_fleet(const FleetWorld& world, const FleetCampaign& campaign,
                                  unsigned jobs,
                                  const std::function<bool(std::uint64_t done)>& told);

std::string fleet_text(const std::vector<FleetRow>& rows, const FleetCampaign& campaign);
std::string fleet_markdown(const std::vector<FleetRow>& rows);
std::string fleet_json(const std::vector<FleetRow>& rows, const FleetCampaign& campaign);

// Beta(precision * mean, precision * (1 - mean)); 0 and 1 stay. `next` gives numbers in [0, 1).
double draw_rate(double mean, double precision, const std::function<double()>& next);

}  // namespace culprit::study::fleet
