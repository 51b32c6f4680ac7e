// Fits the vehicle of SUAVE's model to the published runs. Run it by scripts/fit-suave.
//
// ArduSub and the hydrodynamics under it are not modelled but stood for by a few constants
// (exemplars/suave/model/vehicle.h). This program looks for those with which the managers that the
// paper copied rows of, with their own reactions, come closest to their rows. It minimises, over
// these rows and over search time and distance,
//
//     sum ((mean - mean_p) / sd_p)^2 + 1/4 (log (sd / sd_p))^2
//
// by coordinate descent with halving steps, from the constants as they are. Every candidate plays
// the same seeds. culprit's own rows are not fitted.
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>

#include <fmt/core.h>

#include "study/suave/campaign.h"
#include "study/suave/published.h"

namespace culprit::study {
namespace {

using suave::model::VehicleTraits;

constexpr std::uint64_t kSeed = 0xf17;
constexpr int kHalvings = 3;

struct Knob {
  const char* name;
  double VehicleTraits::*value;
  double step;
};

constexpr std::array kKnobs = {
    Knob{"centre_y", &VehicleTraits::centre_y, 0.10},
    Knob{"centre_y_sd", &VehicleTraits::centre_y_sd, 0.05},
    Knob{"failed_speed", &VehicleTraits::failed_speed, 0.04},
    Knob{"failed_gain", &VehicleTraits::failed_gain, 0.10},
    Knob{"cruise", &VehicleTraits::cruise, 0.05},
    Knob{"climb", &VehicleTraits::climb, 0.02},
    Knob{"gain_per_s", &VehicleTraits::gain_per_s, 0.05},
    Knob{"drift_sd", &VehicleTraits::drift_sd, 0.02},
    Knob{"first_pose_s", &VehicleTraits::first_pose_s, 0.50},
};

double misfit(const Moments& measured, const Moments& published) {
  const double mean = (measured.mean() - published.mean()) / published.sample_sd();
  const double sd = std::log(std::max(measured.sample_sd(), 0.01) / published.sample_sd());
  return mean * mean + sd * sd / 4;
}

double misfit(const VehicleTraits& vehicle, std::uint32_t runs, bool is_told) {
  double sum = 0;
  for (const char* mission : {"standard", "extended"}) {
    SuaveCampaign campaign;
    campaign.plan = *suave::model::find_mission_plan(mission);
    campaign.generation = *suave::model::find_generation("era");
    for (const published::SuaveResult& row : published::suave()) {
      if (row.mission == mission && row.manager != kCulprit)
        campaign.managers.emplace_back(row.manager);
    }
    campaign.runs = runs;
    campaign.seed = kSeed;
    campaign.vehicle = vehicle;
    const SuaveResult result =
        run_campaign(campaign, std::max(1U, std::thread::hardware_concurrency()));
    for (const SuaveRow& row : result.rows) {
      const auto& paper = *published::find_suave(mission, row.manager);
      sum += misfit(row.search_s, paper.search_s) + misfit(row.distance_m, paper.distance_m);
      if (is_told)
        fmt::print(
            "{:<9} {:<12} search {:6.1f} +- {:4.1f} ({:6.1f} +- {:4.1f})  distance {:5.1f} "
            "+- {:4.1f} ({:5.1f} +- {:4.1f})\n",
            mission, row.manager, row.search_s.mean(), row.search_s.sample_sd(),
            paper.search_s.mean(), paper.search_s.sample_sd(), row.distance_m.mean(),
            row.distance_m.sample_sd(), paper.distance_m.mean(), paper.distance_m.sample_sd());
    }
  }
  return sum;
}

void tell(const VehicleTraits& vehicle, std::uint32_t runs) {
  for (const Knob& knob : kKnobs) fmt::print("{} = {:.4g}\n", knob.name, vehicle.*knob.value);
  fmt::print("measured (published):\n");
  fmt::print("misfit {:.3f}\n", misfit(vehicle, runs, true));
}

int fit(std::uint32_t runs) {
  VehicleTraits best;
  tell(best, runs);
  double least = misfit(best, runs, false);
  for (int halving = 0; halving <= kHalvings;) {
    bool is_better = false;
    for (const Knob& knob : kKnobs) {
      for (const double sign : {1.0, -1.0}) {
        VehicleTraits next = best;
        next.*knob.value += sign * std::ldexp(knob.step, -halving);
        if (next.*knob.value <= 0) continue;
        const double found = misfit(next, runs, false);
        if (found >= least) continue;
        best = next;
        least = found;
        is_better = true;
        fmt::print("{} = {:.4g}: misfit {:.3f}\n", knob.name, best.*knob.value, least);
        std::fflush(stdout);
        break;
      }
    }
    if (!is_better) ++halving;
  }
  tell(best, runs);
  return 0;
}

}  // namespace
}  // namespace culprit::study

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 100;
  if (runs < 2) {
    fmt::print(stderr, "usage: suave-fit [RUNS]: how many runs of each row, 2 at least\n");
    return 2;
  }
  return culprit::study::fit(static_cast<std::uint32_t>(runs));
}
