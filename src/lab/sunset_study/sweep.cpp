#include "sunset_study/sweep.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "json/json.h"
#include "study/ordered_work.h"
#include "study/tables/columns.h"
#include "sunset_study/study.h"

namespace culprit::study {
namespace {

using std::chrono::milliseconds;

// The middle of what a log of the exemplar shows is 0.5 s; the rest brackets what a redeployment
// may have taken on the authors' machine.
constexpr std::array kRelaunches = {milliseconds(500), milliseconds(1500), milliseconds(2500),
                                    milliseconds(4000)};
constexpr std::array kPeriods = {milliseconds(100), milliseconds(700)};
constexpr std::array kWindows = {std::size_t{2}, std::size_t{4}, std::size_t{7}};
constexpr std::array kPatience = {0.5, 1.0, 2.0};

struct Planned {
  std::string planner;
  Variation variation;
};

std::vector<Planned> design(const SweepCampaign& campaign) {
  std::vector<Planned> points;
  for (const std::string& planner : campaign.planners)
    for (const Duration relaunch : kRelaunches)
      for (const Duration period : kPeriods)
        for (const std::size_t window : kWindows)
          for (const double patience : kPatience)
            if (planner != "reference" || patience == 1)
              points.push_back({planner, {relaunch, period, window, patience}});
  return points;
}

std::vector<Configuration> rows_for(const std::string& planner, const std::string& profile) {
  std::vector<Configuration> rows;
  for (const published::Result& result : published::ablation())
    rows.push_back({result.switches, planner, profile, Probabilities::kIdeal});
  return rows;
}

double change(const Ablation& ablation, std::size_t effect) {
  constexpr std::size_t kReactionColumn = 1;
  return ablation.effects[effect].changes[kReactionColumn].percent.value_or(0);
}

bool is_shortened(const Effect& effect, Metric metric) {
  for (std::size_t column = 0; column < kPublishedMetrics.size(); ++column) {
    if (kPublishedMetrics[column] == metric)
      return effect.changes[column].significance == published::Significance::kBetter;
  }
  return false;
}

SweepPoint judged(const Planned& planned, const CampaignResult& result) {
  constexpr std::size_t kImpactWithC = 10;  // in the paper's table of effects
  const Ablation ablation = ablations(result).front();
  SweepPoint point{planned.planner, planned.variation, order_agreement(ablation), {}, 0, 0};
  point.reaction_by_impact = {change(ablation, kImpactWithC), change(ablation, kImpactWithC + 1)};
  for (const Effect& effect : ablation.effects) {
    if (effect.published->factor == published::Factor::kImpact)
      point.downtime_shortened += is_shortened(effect, Metric::kDowntime) ? 1 : 0;
  }
  for (const MeanComparison& mean : ablation.means) {
    const double off = std::abs((*mean.row)[mean.metric].mean() - mean.theirs.mean);
    point.means_near += off < mean.theirs.sd / 2 ? 1 : 0;
  }
  return point;
}

double rho(const SweepPoint& point, std::size_t metric) {
  return point.order[metric].spearman_rho.value_or(0);
}

// The lower correlation with the paper's order: of reactions or of downtime.
double weakest(const SweepPoint& point) { return std::min(rho(point, 1), rho(point, 2)); }

std::string text(const Variation& variation) {
  return fmt::format("{:.1f} s, {:.1f} s, {}, {:g}", seconds(*variation.relaunch),
                     seconds(*variation.blackboard_period), *variation.window, variation.patience);
}

struct Level {
  std::string constant;
  std::string value;
};

std::vector<Level> levels_of(const Variation& variation) {
  return {{"relaunch [s]", fmt::format("{:.1f}", seconds(*variation.relaunch))},
          {"blackboard period [s]", fmt::format("{:.1f}", seconds(*variation.blackboard_period))},
          {"frequency window", fmt::format("{}", *variation.window)},
          {"patience", fmt::format("{:g}", variation.patience)}};
}

std::vector<Column> rho_columns() {
  std::vector<Column> columns;
  for (const Metric metric : kPublishedMetrics)
    columns.push_back({"rho", std::string(traits(metric).title)});
  return columns;
}

void add_results(std::vector<Column>& columns) {
  for (Column& column : rho_columns()) columns.push_back(std::move(column));
  columns.push_back({"reaction by S, C on [%]", "without D"});
  columns.push_back({"reaction by S, C on [%]", "with D"});
  columns.push_back({"", "downtime shorter by S, of 4"});
  columns.push_back({"", "means near"});
}

// Over all points of a planner that have this value of a constant.
struct Sum {
  std::array<double, kPublishedMetrics.size()> rho{};
  std::array<double, 2> reaction{};
  double shortened = 0;
  double near = 0;
  double points = 0;
};
using Sums = std::vector<std::pair<std::array<std::string, 3>, Sum>>;  // planner, constant, value

Sums sums_of(const std::vector<SweepPoint>& points, const SweepCampaign& campaign) {
  Sums sums;
  const auto sum_of = [&](const std::array<std::string, 3>& key) -> Sum& {
    const auto found =
        std::find_if(sums.begin(), sums.end(), [&](const auto& each) { return each.first == key; });
    return found != sums.end() ? found->second : sums.emplace_back(key, Sum{}).second;
  };
  for (const std::string& planner : campaign.planners) {
    for (std::size_t constant = 0; constant < levels_of(points.front().variation).size();
         ++constant) {
      for (const SweepPoint& point : points) {
        if (point.planner != planner) continue;
        const Level level = levels_of(point.variation)[constant];
        Sum& sum = sum_of({planner, level.constant, level.value});
        for (std::size_t i = 0; i < sum.rho.size(); ++i) sum.rho[i] += rho(point, i);
        for (std::size_t i = 0; i < 2; ++i) sum.reaction[i] += point.reaction_by_impact[i];
        sum.shortened += point.downtime_shortened;
        sum.near += point.means_near;
        sum.points += 1;
      }
    }
  }
  return sums;
}

Table effects_table(const std::vector<SweepPoint>& points, const SweepCampaign& campaign) {
  Table effects{"sweep",
                "Order beside the paper's, by unpublished constant",
                {{"", "planner", "", "", Align::kLeft},
                 {"", "constant", "", "", Align::kLeft},
                 {"", "value"},
                 {"", "points"}},
                {},
                {}};
  add_results(effects.columns);
  for (const auto& [key, sum] : sums_of(points, campaign)) {
    std::vector<Cell> cells = {{key[0]}, {key[1]}, {key[2]}, {number(sum.points, 0)}};
    for (const double each : sum.rho) cells.push_back({number(each / sum.points)});
    for (const double each : sum.reaction) cells.push_back({number(each / sum.points, 0)});
    cells.push_back({number(sum.shortened / sum.points, 1)});
    cells.push_back({number(sum.near / sum.points, 1)});
    effects.rows.push_back(std::move(cells));
  }
  effects.notes.push_back(
      "Means over all points with that value. Means near: of the 32, those that differ from the "
      "paper's by less than half of its sd.");
  return effects;
}

Table closest_table(const std::vector<SweepPoint>& points, const SweepCampaign& campaign) {
  Table closest{"sweep-closest",
                "Points whose orders of reaction and downtime come closest to the paper's",
                {{"", "planner", "", "", Align::kLeft},
                 {"", "relaunch, period, window, patience", "", "", Align::kLeft}},
                {},
                {}};
  add_results(closest.columns);
  constexpr std::size_t kShown = 3;
  for (const std::string& planner : campaign.planners) {
    std::vector<const SweepPoint*> own;
    for (const SweepPoint& point : points)
      if (point.planner == planner) own.push_back(&point);
    std::stable_sort(own.begin(), own.end(), [](const SweepPoint* a, const SweepPoint* b) {
      return weakest(*a) > weakest(*b);
    });
    const auto in_order =
        std::count_if(own.begin(), own.end(), [](const SweepPoint* p) { return weakest(*p) > 0; });
    const auto significant = std::count_if(own.begin(), own.end(), [](const SweepPoint* p) {
      return weakest(*p) > 0 && p->order[1].p.value_or(1) < 0.05 &&
             p->order[2].p.value_or(1) < 0.05;
    });
    for (std::size_t i = 0; i < std::min(kShown, own.size()); ++i) {
      const SweepPoint& point = *own[i];
      std::vector<Cell> cells = {{planner}, {text(point.variation)}};
      for (std::size_t metric = 0; metric < kPublishedMetrics.size(); ++metric)
        cells.push_back({number(rho(point, metric))});
      for (const double each : point.reaction_by_impact) cells.push_back({number(each, 0)});
      cells.push_back({fmt::format("{}", point.downtime_shortened)});
      cells.push_back({fmt::format("{}", point.means_near)});
      closest.rows.push_back(std::move(cells));
    }
    closest.notes.push_back(
        fmt::format("{}: both correlations are positive at {} of {} points, and significant at {}.",
                    planner, in_order, own.size(), significant));
  }
  closest.notes.push_back(
      fmt::format("{} runs of each configuration, seed {}.", campaign.runs, campaign.seed));
  return closest;
}

}  // namespace

std::uint64_t sweep_size(const SweepCampaign& campaign) { return design(campaign).size(); }

Expected<std::vector<SweepPoint>> sweep(const SweepCampaign& campaign, unsigned jobs,
                                        const std::function<bool(std::uint64_t)>& told) {
  for (const std::string& planner : campaign.planners) {
    if (!has_switches(planner))
      return Error{"--sweep varies planners with D, C and S: paper and reference"};
  }
  std::vector<SweepPoint> points;
  for (const Planned& planned : design(campaign)) {
    Campaign rows{rows_for(planned.planner, campaign.profile), campaign.runs, campaign.seed, "",
                  ""};
    const auto study = SunsetStudy::make(rows.rows, rows.seed, planned.variation);
    if (!study) return Error{study.error()};
    CampaignFold fold(rows);
    work_in_order(
        0, rows.size(), jobs, [&](std::uint64_t i) { return study->run(rows[i]); },
        [&](std::uint64_t, const RunMetrics& run) {
          fold.add(run);
          return true;
        });
    points.push_back(judged(planned, std::move(fold).result()));
    if (!told(points.size())) break;
  }
  return points;
}

std::vector<Table> sweep_tables(const std::vector<SweepPoint>& points,
                                const SweepCampaign& campaign) {
  return {effects_table(points, campaign), closest_table(points, campaign)};
}

std::string sweep_json(const std::vector<SweepPoint>& points, const SweepCampaign& campaign,
                       const std::string& command, const std::string& version) {
  Json all = Json::array();
  for (const SweepPoint& point : points) {
    Json rho = Json::object();
    for (const OrderAgreement& agreement : point.order) {
      const auto& known = agreement.spearman_rho;
      rho[std::string(traits(agreement.metric).key)] = known ? Json(*known) : Json();
    }
    all.push_back({{"planner", point.planner},
                   {"relaunch_s", seconds(*point.variation.relaunch)},
                   {"blackboard_period_s", seconds(*point.variation.blackboard_period)},
                   {"window", *point.variation.window},
                   {"patience", point.variation.patience},
                   {"rho", std::move(rho)},
                   {"reaction_by_impact", point.reaction_by_impact},
                   {"downtime_shortened", point.downtime_shortened},
                   {"means_near", point.means_near}});
  }
  return to_indented({{"study", "sunset"},
                      {"campaign",
                       {{"command", command},
                        {"version", version},
                        {"profile", campaign.profile},
                        {"runs", campaign.runs},
                        {"seed", campaign.seed}}},
                      {"sweep", std::move(all)}}) +
         "\n";
}

}  // namespace culprit::study
