#include "suave_study/fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "suave_study/published.h"
namespace culprit::study {
namespace {

using suave::model::VehicleTraits;

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

bool has_spread(const Moments& moments) { return moments.count() >= 2 && moments.sample_sd() > 0; }

double misfit(const Moments& measured, const Moments& wanted) {
  constexpr double kLeast = 0.01;
  const double sd = std::max(wanted.sample_sd(), kLeast);
  const double mean = (measured.mean() - wanted.mean()) / sd;
  const double spread = std::log(std::max(measured.sample_sd(), kLeast) / sd);
  return mean * mean + spread * spread / 4;
}

double misfit(const std::vector<FitCampaign>& campaigns, const VehicleTraits& vehicle,
              unsigned jobs) {
  double sum = 0;
  for (const FitCampaign& each : campaigns) {
    SuaveCampaign campaign = each.campaign;
    campaign.vehicle = vehicle;
    const SuaveResult result = run_campaign(campaign, jobs);
    for (std::size_t i = 0; i < result.rows.size(); ++i)
      sum += misfit(result.rows[i].search_s, each.targets[i].search_s) +
             misfit(result.rows[i].distance_m, each.targets[i].distance_m);
  }
  return sum;
}

// Leaves out what cannot be fitted to, and gives each campaign the managers of its targets.
void prepare(std::vector<FitCampaign>& campaigns, std::uint32_t runs) {
  for (FitCampaign& each : campaigns) {
    std::erase_if(each.targets, [](const FitTarget& target) {
      return target.manager == kCulprit || !has_spread(target.search_s) ||
             !has_spread(target.distance_m);
    });
    each.campaign.managers.clear();
    for (const FitTarget& target : each.targets) each.campaign.managers.push_back(target.manager);
    each.campaign.runs = runs;
  }
  std::erase_if(campaigns, [](const FitCampaign& each) { return each.targets.empty(); });
}

}  // namespace

Expected<VehicleFit> fit_vehicle(std::vector<FitCampaign> campaigns, VehicleTraits begin,
                                 std::uint32_t runs, unsigned jobs,
                                 const std::function<void(const std::string&)>& tell) {
  prepare(campaigns, runs);
  if (campaigns.empty())
    return Error{"there is nothing to fit to: no manager but culprit has two runs that differ"};
  VehicleFit fit;
  fit.vehicle = begin;
  fit.misfit = fit.misfit_before = misfit(campaigns, begin, jobs);
  for (int halving = 0; halving <= kHalvings;) {
    bool is_better = false;
    for (const Knob& knob : kKnobs) {
      for (const double sign : {1.0, -1.0}) {
        VehicleTraits next = fit.vehicle;
        next.*knob.value += sign * std::ldexp(knob.step, -halving);
        if (next.*knob.value <= 0) continue;
        const double found = misfit(campaigns, next, jobs);
        if (found >= fit.misfit) continue;
        fit.vehicle = next;
        fit.misfit = found;
        is_better = true;
        tell(fmt::format("{} = {:.4g}: misfit {:.3f}", knob.name, next.*knob.value, found));
        break;
      }
    }
    if (!is_better) ++halving;
  }
  return fit;
}

Expected<std::vector<FitCampaign>> published_targets(const std::vector<std::string>& rows) {
  constexpr std::uint64_t kSeed = 0xf17;
  std::vector<FitCampaign> campaigns;
  std::vector<std::string> left = rows;
  for (const char* mission : {"standard", "extended"}) {
    FitCampaign each;
    each.campaign.plan = *suave::model::find_mission_plan(mission);
    each.campaign.generation = *suave::model::find_generation("era");
    each.campaign.seed = kSeed;
    for (const published::SuaveResult& row : published::suave()) {
      if (row.mission != mission || row.manager == kCulprit) continue;
      const std::string prefix = row.mission == "standard" ? "" : std::string(row.mission) + ":";
      if (!rows.empty() && std::erase(left, prefix + std::string(row.manager)) == 0) continue;
      each.targets.push_back({std::string(row.manager), row.search_s, row.distance_m});
    }
    campaigns.push_back(std::move(each));
  }
  if (!left.empty())
    return Error{"the paper's table has no row '" + left.front() +
                 "' of others; there are none, bt, metacontrol, rosa, extended:bt, extended:rosa"};
  return campaigns;
}

}  // namespace culprit::study
