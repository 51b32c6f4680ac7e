#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "base/invariant.h"
#include "study/statistics/welch.h"
#include "study/tables/claims_tables.h"
#include "study/tables/columns.h"
#include "study/tables/study_tables.h"

namespace culprit::study {
namespace {

// The two columns of a metric.
void add_pair(Table& table, Metric metric) {
  const MetricTraits& metric_traits = traits(metric);
  for (const char* title : {"ours", "paper"}) {
    table.columns.push_back({std::string(metric_traits.title), title,
                             std::string(metric_traits.latex), "", Align::kRight});
  }
}

std::string compact(const PaperSwitches& switches) {
  std::string text;
  for (const Cell& cell : switch_cells(switches)) text += cell.text;
  return text;
}

std::string_view name(published::Factor factor) {
  switch (factor) {
    case published::Factor::kDependencies:
      return "dependency graph";
    case published::Factor::kCriticality:
      return "criticality level";
    case published::Factor::kImpact:
      return "system impact";
  }
  return "";
}

Shade shade(published::Significance significance) {
  switch (significance) {
    case published::Significance::kNotSignificant:
      return Shade::kNotSignificant;
    case published::Significance::kBetter:
      return Shade::kBetter;
    case published::Significance::kWorse:
      return Shade::kWorse;
  }
  return Shade::kNone;
}

// The largest significant changes of a metric, to scale the colours.
struct Largest {
  double ours = 0;
  double theirs = 0;
};

Largest largest(const Ablation& ablation, std::size_t metric) {
  Largest largest;
  for (const Effect& effect : ablation.effects) {
    const Change& change = effect.changes[metric];
    if (change.significance != published::Significance::kNotSignificant && change.percent)
      largest.ours = std::max(largest.ours, std::abs(*change.percent));
    if (change.is_significant_for_them())
      largest.theirs = std::max(largest.theirs, std::abs(change.theirs.percent));
  }
  return largest;
}

Cell change_cell(std::optional<double> percent, published::Significance significance,
                 double largest) {
  Cell cell{percent ? number(*percent) : "–", shade(significance), 0, false};
  if (significance != published::Significance::kNotSignificant)
    cell.strength = percent && largest > 0 ? std::max(0.25, std::abs(*percent) / largest) : 1;
  return cell;
}

// "p < 0.001", "p = 0.034".
std::string stated(double p) { return (p < 0.001 ? "p " : "p = ") + p_value(p); }

// "resolved / executed F(7, 1288) = 52.10, p < 0.001; ..."
std::string anova_note(const Ablation& ablation) {
  std::string out = "One-way ANOVA:";
  for (std::size_t i = 0; i < kPublishedMetrics.size(); ++i) {
    const std::string_view title = traits(kPublishedMetrics[i]).title;
    const std::optional<Anova>& anova = ablation.anovas[i];
    out += i == 0 ? " " : "; ";
    out += anova ? fmt::format("{} F({:g}, {:g}) = {}, {}", title, anova->degrees_between,
                               anova->degrees_within, number(anova->f), stated(anova->p))
                 : fmt::format("{} too few values", title);
  }
  return out + ".";
}

std::vector<Cell> robustness_row(const std::string& name, const Row& row) {
  std::vector<Cell> cells = {{name}};
  const std::vector<MeanComparison> theirs = compare_means(row);
  for (std::size_t i = 0; i < kPublishedMetrics.size(); ++i) {
    cells.push_back({mean_sd(row[kPublishedMetrics[i]])});
    cells.push_back({theirs.empty() ? "–" : mean_sd(theirs[i].theirs)});
  }
  return cells;
}

// Compares the live robot with its model.
constexpr std::array kComparedLive = {
    Metric::kRatio,          Metric::kReaction,           Metric::kUnnecessaryRedeployments,
    Metric::kHonestDowntime, Metric::kStrategiesPerFault, Metric::kRecovery};

// The same configuration on the model; null if that was not played, or if `row` is no live one.
const Row* model_of(const Row& row, const CampaignResult& result) {
  if (row.configuration.profile != kLiveRobot) return nullptr;
  Configuration model = row.configuration;
  model.profile = kModelOfLiveRobot;
  return result.find(model);
}

std::string difference(const std::optional<WelchTest>& test) {
  return test ? stated(test->p) : "–";
}

std::vector<Cell> welch_row(const Row& ideal, const Row& misspecified) {
  std::vector<Cell> cells = {{"difference"}};
  const auto theirs = published::robustness();
  for (std::size_t i = 0; i < kPublishedMetrics.size(); ++i) {
    const Metric metric = kPublishedMetrics[i];
    cells.push_back(
        {difference(welch_test(ideal[metric].moments(), misspecified[metric].moments()))});
    const bool is_count_known = metric != Metric::kReaction;
    cells.push_back({is_count_known ? difference(welch_test(published::sample(theirs[0].values[i]),
                                                            published::sample(theirs[1].values[i])))
                                    : "–"});
  }
  return cells;
}

}  // namespace

Table comparison_table(const Ablation& ablation) {
  Table table{id_of("comparison", ablation.planner, ablation.profile),
              "Ours beside the paper's: " + played(ablation.planner, ablation.profile),
              switch_columns(),
              {},
              {}};
  for (const Metric metric : kPublishedMetrics) add_pair(table, metric);
  for (std::size_t i = 0; i < ablation.means.size(); ++i) {
    const MeanComparison& mean = ablation.means[i];
    if (i % kPublishedMetrics.size() == 0)
      table.rows.push_back(switch_cells(mean.row->configuration.switches));
    const std::string mark = mean.is_within ? " ✓" : " ✗";
    table.rows.back().push_back({mean_sd((*mean.row)[mean.metric]) + mark});
    table.rows.back().push_back({mean_sd(mean.theirs)});
  }
  const Agreement count = agreement(ablation);
  table.notes.push_back(fmt::format("✓ our mean lies within the paper's mean ± 1 sd: {} of {} do.",
                                    count.means_within, count.means));
  return table;
}

Table effects_table(const Ablation& ablation) {
  Table table{
      id_of("effects", ablation.planner, ablation.profile),
      "Change in percent by switching one factor on: " + played(ablation.planner, ablation.profile),
      {{"", "factor", "", "", Align::kLeft},
       {"", "from", "", "", Align::kCentre},
       {"", "to", "", "", Align::kCentre}},
      {},
      {}};
  for (const Metric metric : kPublishedMetrics) add_pair(table, metric);
  for (const Effect& effect : ablation.effects) {
    std::vector<Cell> cells = {{std::string(name(effect.published->factor))},
                               {compact(effect.published->without)},
                               {compact(effect.published->with)}};
    for (std::size_t i = 0; i < kPublishedMetrics.size(); ++i) {
      const Change& change = effect.changes[i];
      const Largest scale = largest(ablation, i);
      cells.push_back(change_cell(change.percent, change.significance, scale.ours));
      cells.push_back(change_cell(change.theirs.percent, change.theirs.significance, scale.theirs));
    }
    table.rows.push_back(std::move(cells));
  }
  const Agreement count = agreement(ablation);
  table.notes.push_back(fmt::format(
      "Tukey's HSD among the eight configurations at 95 %. {} of the {} effects that are "
      "significant in the paper have the same sign here; {} of all {} have the same verdict.",
      count.significant_signs, count.significant, count.same_significance, count.effects));
  table.notes.push_back(anova_note(ablation));
  return table;
}

Table live_table(const CampaignResult& result) {
  const ConfigurationColumns configuration(result.rows);
  Table table{"live", "The live robot beside its model", configuration.columns(), {}, {}};
  for (const Metric metric : kComparedLive) {
    const MetricTraits& metric_traits = traits(metric);
    for (const char* title : {"live", "model"})
      table.columns.push_back({std::string(metric_traits.title), title,
                               std::string(metric_traits.latex), "", Align::kRight});
  }
  int means = 0;
  int alike = 0;
  for (const Row& row : result.rows) {
    const Row* model = model_of(row, result);
    if (model == nullptr) continue;
    table.rows.push_back(configuration.cells(row.configuration));
    for (const Metric metric : kComparedLive) {
      const auto test = welch_test(row[metric].moments(), (*model)[metric].moments());
      const bool differs = test ? test->p < 0.05 : row[metric].mean() != (*model)[metric].mean();
      ++means;
      alike += differs ? 0 : 1;
      table.rows.back().push_back({mean_sd(row[metric]) + (differs ? " ✗" : " ✓")});
      table.rows.back().push_back({mean_sd((*model)[metric])});
    }
  }
  table.notes.push_back(
      fmt::format("✗ the means differ significantly (Welch's t at 95 %, each for itself): {} of {} "
                  "do not. Few runs show few differences.",
                  alike, means));
  return table;
}

Table robustness_table(const Row& ideal, const Row& misspecified) {
  CULPRIT_ASSERT(ideal.configuration.planner == misspecified.configuration.planner &&
                 ideal.configuration.profile == misspecified.configuration.profile);
  Table table{id_of("robustness", ideal.configuration.planner, ideal.configuration.profile),
              "Probabilities off by 20 %: " +
                  played(ideal.configuration.planner, ideal.configuration.profile),
              {{"", "initial P", "", "Initial $P_s$", Align::kLeft}},
              {},
              {}};
  for (const Metric metric : kPublishedMetrics) add_pair(table, metric);
  table.rows = {robustness_row("ideal", ideal), robustness_row("misspecified", misspecified),
                welch_row(ideal, misspecified)};
  table.notes.push_back(
      "Differences by Welch's t; the paper's from its printed summaries, but for the reaction "
      "times, "
      "whose number it does not print. The paper reports none as significant.");
  return table;
}

std::vector<Table> tables(const Findings& findings) {
  const CampaignResult& result = findings.campaign;
  std::vector<Table> tables;
  if (!result.rows.empty()) {
    tables.push_back(results_table(result));
    tables.push_back(honest_table(result));
    tables.push_back(root_cause_table(result));
  }
  const std::vector<Ablation> compared = ablations(result);
  for (const Ablation& ablation : compared) {
    tables.push_back(comparison_table(ablation));
    tables.push_back(effects_table(ablation));
  }
  if (std::any_of(result.rows.begin(), result.rows.end(),
                  [&](const Row& row) { return model_of(row, result) != nullptr; }))
    tables.push_back(live_table(result));
  for (const Row& row : result.rows) {
    if (row.configuration.probabilities != Probabilities::kMisspecified) continue;
    Configuration ideal = row.configuration;
    ideal.probabilities = Probabilities::kIdeal;
    if (const Row* beside = result.find(ideal)) tables.push_back(robustness_table(*beside, row));
  }
  if (!findings.learning.empty()) tables.push_back(learning_table(findings.learning));
  if (!compared.empty()) {
    tables.push_back(order_table(compared));
    tables.push_back(claims_table(findings, compared));
  }
  return tables;
}

}  // namespace culprit::study
