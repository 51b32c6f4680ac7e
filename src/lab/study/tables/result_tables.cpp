#include <optional>

#include <fmt/core.h>

#include "base/invariant.h"
#include "study/tables/columns.h"
#include "study/tables/study_tables.h"

namespace culprit::study {
namespace {

// The best mean of a metric; nothing if no row has one.
std::optional<double> best(const std::vector<Row>& rows, Metric metric) {
  std::optional<double> best;
  for (const Row& row : rows) {
    if (row[metric].count() == 0) continue;
    const double mean = row[metric].mean();
    const bool is_better =
        !best || (traits(metric).better == Better::kHigher ? mean > *best : mean < *best);
    if (is_better) best = mean;
  }
  return best;
}

Cell result_cell(const Row& row, Metric metric, std::optional<double> best_mean) {
  const Summary& summary = row[metric];
  const bool is_best = summary.count() > 0 && best_mean && summary.mean() == *best_mean;
  return {mean_sd(summary), Shade::kNone, 0, is_best};
}

std::string with_interval(const Summary& summary) {
  if (summary.count() == 0) return "–";
  const auto interval = summary.interval();
  if (!interval) return number(summary.mean());
  return fmt::format("{} [{}, {}]", number(summary.mean()), number(interval->low),
                     number(interval->high));
}

Table interval_table(const CampaignResult& result, std::string id, const std::string& caption,
                     const std::vector<Metric>& metrics) {
  const ConfigurationColumns configuration(result.rows);
  Table table{std::move(id),
              caption + ": mean [95 % interval of the mean]",
              configuration.columns(),
              {},
              {"Intervals by bootstrap over runs."}};
  for (const Metric metric : metrics) table.columns.push_back(metric_column(metric));
  for (const Row& row : result.rows) {
    std::vector<Cell> cells = configuration.cells(row.configuration);
    for (const Metric metric : metrics) cells.push_back({with_interval(row[metric])});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

std::string runs_note(const CampaignResult& result) {
  return fmt::format("{} runs each, seed {}, culprit {}: {}", result.campaign.runs,
                     result.campaign.seed, result.campaign.version, result.campaign.command);
}

}  // namespace

Table results_table(const CampaignResult& result) {
  const ConfigurationColumns configuration(result.rows);
  Table table{"ablation",
              "Results by configuration: the paper's metrics, mean ± sd",
              configuration.columns(),
              {},
              {}};
  for (const Metric metric : kPublishedMetrics) table.columns.push_back(metric_column(metric));
  for (const Row& row : result.rows) {
    std::vector<Cell> cells = configuration.cells(row.configuration);
    for (const Metric metric : kPublishedMetrics)
      cells.push_back(result_cell(row, metric, best(result.rows, metric)));
    table.rows.push_back(std::move(cells));
  }
  if (configuration.has_switches())
    table.notes.push_back("D: dependency graph, C: criticality level, S: system impact.");
  table.notes.push_back("The best mean of each metric is bold.");
  table.notes.push_back(runs_note(result));
  return table;
}

Table honest_table(const CampaignResult& result) {
  Table table = interval_table(result, "honest", "Honest metrics",
                               {kHonestCosts.begin(), kHonestCosts.end()});
  table.columns.push_back({"", fmt::format("not recovered of {}", result.campaign.runs)});
  table.columns.push_back({"", "on the front", "", "", Align::kCentre});
  const auto front = on_front(result);
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    const Row& row = result.rows[i];
    table.rows[i].push_back({fmt::format("{}", row[Metric::kRecovery].censored())});
    table.rows[i].push_back({!front[i] ? "" : *front[i] ? "✓" : "–"});
  }
  table.notes.push_back(
      "A run that did not recover counts with the time that it was watched: a lower bound.");
  table.notes.push_back(
      "On the (Pareto) front: no other row of the same profile and probabilities has five means as "
      "low, and a lower one.");
  return table;
}

Table root_cause_table(const CampaignResult& result) {
  return interval_table(result, "root-causes", "Root causes",
                        {Metric::kTopCauseRight, Metric::kExactCausesRight});
}

Table learning_table(const std::vector<LearningCurve>& curves) {
  CULPRIT_ASSERT(!curves.empty());
  Table table{"learning",
              "Learned success probabilities beside the true rates",
              {{"", "failure", "", "", Align::kLeft},
               {"", "rule", "", "", Align::kLeft},
               {"", "strategy", "", "", Align::kLeft},
               {"", "executed"},
               {"", "learned from"},
               {"not learned from", "outage"},
               {"not learned from", "repair beside"},
               {"not learned from", "run over"},
               {"", "initial P", "", "Initial $P_s$"},
               {"", "learned P", "", "Learned $P_s$"},
               {"", "true rate"},
               {"", "error"},
               {"", "of it the prior"},
               {"", "standard error"},
               {"all executed", "cleared"},
               {"all executed", "true rate"}},
              {},
              {}};
  for (const LearningCurve& curve : curves) {
    const Moments last = curve.learned.empty() ? Moments() : curve.learned.back();
    const bool is_repeated = last.count() > 1;
    const std::string learned = last.count() == 0 ? "–"
                                : is_repeated
                                    ? number(last.mean()) + " ± " + number(last.population_sd())
                                    : number(last.mean());
    table.rows.push_back({{curve.failure},
                          {curve.rule},
                          {curve.strategy},
                          {number(curve.executed, 0)},
                          {number(curve.counted, 0)},
                          {number(curve.hidden, 0)},
                          {number(curve.beside, 0)},
                          {number(curve.undecided, 0)},
                          {number(curve.initial)},
                          {learned},
                          {number(curve.truth)},
                          {last.count() == 0 ? "–" : number(curve.error())},
                          {last.count() == 0 ? "–" : number(curve.error_of_prior())},
                          {curve.counted == 0 ? "–" : number(curve.standard_error())},
                          {number(curve.verdicts)},
                          {number(curve.truth_of_all)}});
  }
  table.notes.push_back(fmt::format(
      "After {} experiments. The paper shows its own learning (c_p = {:g}) only as a figure of "
      "F1 and F4, without numbers.",
      curves.front().learned.size(), published::kLearning.confidence));
  table.notes.push_back(
      "The true rate is the share of a strategy's learned outcomes that ended the fault; the last "
      "column, of all outcomes. The error has two parts: the rest of the initial P, which weighs "
      "as much as c_p outcomes, and the standard error of a series' number of outcomes.");
  table.notes.push_back(
      "Not learned from: an outage may have hidden the outcome; another repair can have had the "
      "same effect, or nothing was changed; the run ended first. Cleared: the share of all "
      "executions after which the failure was gone, which counts what others did.");
  return table;
}

}  // namespace culprit::study
