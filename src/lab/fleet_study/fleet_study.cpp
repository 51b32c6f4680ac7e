#include "fleet_study/fleet_study.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "json/json.h"
#include "simulation/random.h"
#include "study/ordered_work.h"

namespace culprit::study::fleet {
namespace {

// Of one model: failed strategies of a new robot.
struct Trial {
  double guesses = 0;
  double fleet = 0;
  double veteran = 0;
};
struct Trials {
  Trial alike;
  Trial differing;
};

constexpr std::uint64_t kNewcomer = 1'000'000;  // no robot at work has this number

double failed_at_first(FleetRobot& robot, std::vector<Belief> beliefs, std::uint32_t first) {
  int failures = 0;
  int failed = 0;
  while (failures < static_cast<int>(first)) {
    const Episode episode = robot.live_through(beliefs);
    failures += std::max(1, episode.failures);  // one that saw nothing does not go on for ever
    failed += episode.failed;
  }
  return static_cast<double>(failed) * first / failures;
}

std::vector<Belief> learned_by(FleetRobot& robot, std::vector<Belief> beliefs,
                               std::uint32_t experience) {
  for (std::uint32_t i = 0; i < experience; ++i) (void)robot.live_through(beliefs);
  return beliefs;
}

std::vector<Belief> priors_of(const FleetWorld& world, const FleetCampaign& campaign,
                              std::uint64_t model) {
  const std::vector<Belief> guesses = world.guesses(model);
  std::vector<RobotOutcomes> sums(guesses.size());
  for (std::uint32_t r = 0; r < campaign.robots; ++r) {
    const auto robot = world.robot(model, r, 0);
    const std::vector<Belief> learned = learned_by(*robot, guesses, campaign.experience);
    for (std::size_t s = 0; s < guesses.size(); ++s)
      sums[s].add(std::max(0.0, learned[s].alpha - guesses[s].alpha),
                  std::max(0.0, learned[s].beta - guesses[s].beta));
  }
  std::vector<Belief> priors;
  for (std::size_t s = 0; s < guesses.size(); ++s)
    priors.push_back(pooled_prior(guesses[s], sums[s], {}, campaign.pooling));
  return priors;
}

Trials try_model(const FleetWorld& world, const FleetCampaign& campaign, std::uint64_t index) {
  const std::uint64_t model = simulation::mix(campaign.seed * 1000 + index);
  const std::uint64_t other = simulation::mix(model + 1);
  const std::vector<Belief> guesses = world.guesses(model);
  const std::vector<Belief> priors = priors_of(world, campaign, model);
  const auto trial_of = [&](std::uint64_t its_model) {
    // The same faults and luck, as far as decisions let them.
    const auto newcomer = [&](std::uint64_t life) {
      return world.robot(its_model, kNewcomer, life);
    };
    const auto tried_with = [&](const std::vector<Belief>& beliefs) {
      return failed_at_first(*newcomer(1), beliefs, campaign.first);
    };
    return Trial{tried_with(guesses), tried_with(priors),
                 tried_with(learned_by(*newcomer(2), guesses, campaign.experience))};
  };
  return {trial_of(model), trial_of(other)};
}

FleetRow row_of(const std::string& world, bool differs, const std::vector<Trial>& trials,
                std::uint64_t seed) {
  FleetRow row{world, differs};
  const auto count = static_cast<double>(trials.size());
  for (const Trial& each : trials) {
    row.guesses += each.guesses / count;
    row.fleet += each.fleet / count;
    row.veteran += each.veteran / count;
  }
  row.ratio = row.guesses > 0 ? row.fleet / row.guesses : 1;
  constexpr int kReplicates = 2000;
  std::vector<double> ratios;
  simulation::Random random(seed);
  for (int i = 0; i < kReplicates; ++i) {
    double guesses = 0;
    double fleet = 0;
    for (std::size_t n = 0; n < trials.size(); ++n) {
      const Trial& drawn =
          trials[static_cast<std::size_t>(random.below(static_cast<int>(trials.size())))];
      guesses += drawn.guesses;
      fleet += drawn.fleet;
    }
    ratios.push_back(guesses > 0 ? fleet / guesses : 1);
  }
  std::ranges::sort(ratios);
  row.low = ratios[kReplicates / 40];
  row.high = ratios[kReplicates - 1 - kReplicates / 40];
  return row;
}

}  // namespace

std::vector<FleetRow> study_fleet(const FleetWorld& world, const FleetCampaign& campaign,
                                  unsigned jobs,
                                  const std::function<bool(std::uint64_t done)>& told) {
  std::vector<Trial> alike;
  std::vector<Trial> differing;
  work_in_order(
      0, campaign.models, jobs, [&](std::uint64_t i) { return try_model(world, campaign, i); },
      [&](std::uint64_t i, const Trials& trials) {
        alike.push_back(trials.alike);
        differing.push_back(trials.differing);
        return !told || told(i + 1);
      });
  if (alike.size() < campaign.models) return {};
  return {row_of(world.name(), false, alike, campaign.seed),
          row_of(world.name(), true, differing, campaign.seed)};
}

double draw_rate(double mean, double precision, const std::function<double()>& next) {
  if (mean <= 0 || mean >= 1) return mean;
  // A sample of a Gamma distribution (Marsaglia and Tsang, ACM TOMS 26, 2000).
  const auto gamma = [&](double shape) {
    double boost = 1;
    if (shape < 1) {
      boost = std::pow(1 - next(), 1 / shape);
      shape += 1;
    }
    const double d = shape - 1.0 / 3;
    const double c = 1 / std::sqrt(9 * d);
    while (true) {
      // Box and Muller's normal deviate.
      const double x = std::sqrt(-2 * std::log(1 - next())) * std::cos(2 * M_PI * next());
      const double v = std::pow(1 + c * x, 3);
      if (v <= 0) continue;
      if (std::log(1 - next()) < 0.5 * x * x + d - d * v + d * std::log(v)) return boost * d * v;
    }
  };
  const double a = gamma(precision * mean);
  const double b = gamma(precision * (1 - mean));
  return a + b > 0 ? a / (a + b) : mean;
}

std::string fleet_text(const std::vector<FleetRow>& rows, const FleetCampaign& campaign) {
  std::string text = fmt::format(
      "Failed strategies of a new robot in its first {} failures; {} models of {} robots with {} "
      "episodes each\n\n{:<34} {:<14} {:>9} {:>9} {:>9} {:>24}\n",
      campaign.first, campaign.models, campaign.robots, campaign.experience, "robots",
      "the new one", "guesses", "fleet", "veteran", "fleet / guesses");
  for (const FleetRow& row : rows)
    text += fmt::format("{:<34} {:<14} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.2f} [{:.2f}, {:.2f}]\n",
                        row.world, row.differs ? "differs" : "is like them", row.guesses, row.fleet,
                        row.veteran, row.ratio, row.low, row.high);
  return text;
}

std::string fleet_markdown(const std::vector<FleetRow>& rows) {
  std::string text =
      "| robots | the new one | with the file's guesses | with the fleet's prior | a veteran | "
      "fleet "
      "/ guesses \\[95 %\\] |\n| :-- | :-- | --: | --: | --: | --: |\n";
  for (const FleetRow& row : rows)
    text += fmt::format("| {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.2f} \\[{:.2f}, {:.2f}\\] |\n",
                        row.world, row.differs ? "differs" : "is like them", row.guesses, row.fleet,
                        row.veteran, row.ratio, row.low, row.high);
  return text;
}

std::string fleet_json(const std::vector<FleetRow>& rows, const FleetCampaign& campaign) {
  Json json = {{"study", "fleet"},          {"models", campaign.models},
               {"robots", campaign.robots}, {"experience", campaign.experience},
               {"first", campaign.first},   {"most", campaign.pooling.most},
               {"seed", campaign.seed},     {"rows", Json::array()}};
  for (const FleetRow& row : rows)
    json["rows"].push_back({{"robots", row.world},
                            {"differs", row.differs},
                            {"guesses", row.guesses},
                            {"fleet", row.fleet},
                            {"veteran", row.veteran},
                            {"ratio", row.ratio},
                            {"low", row.low},
                            {"high", row.high}});
  return to_indented(json) + "\n";
}

}  // namespace culprit::study::fleet
