#include "study/tables/columns.h"

#include <cmath>

#include <fmt/core.h>

namespace culprit::study {
namespace {

// With a dash for each character that is no letter, digit, dash or underscore.
std::string safe_id(std::string text) {
  for (char& c : text) {
    const bool is_safe = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                         (c >= '0' && c <= '9') || c == '_' || c == '-';
    if (!is_safe) c = '-';
  }
  return text;
}

}  // namespace

std::string number(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.front() != '-') return text;
  text.erase(0, 1);
  return text.find_first_not_of("0.") == std::string::npos ? text : "−" + text;
}

std::string mean_sd(const Summary& summary) {
  if (summary.count() == 0) return "–";
  return number(summary.mean()) + " ± " + number(summary.sd());
}

std::string mean_sd(const published::MeanSd& value) {
  return number(value.mean) + " ± " + number(value.sd);
}

std::string p_value(double p) { return p < 0.001 ? "< 0.001" : number(p, 3); }

std::vector<Column> switch_columns() {
  return {{"", "D", "", "", Align::kCentre},
          {"", "C", "", "", Align::kCentre},
          {"", "S", "", "", Align::kCentre}};
}

std::vector<Cell> switch_cells(const PaperSwitches& switches) {
  const auto mark = [](bool is_on) { return Cell{is_on ? "✓" : "–"}; };
  return {mark(switches.dependencies), mark(switches.criticality), mark(switches.impact)};
}

ConfigurationColumns::ConfigurationColumns(const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    const Configuration& first = rows.front().configuration;
    const Configuration& other = row.configuration;
    has_switches_ = has_switches_ || other.switches != first.switches;
    has_planners_ = has_planners_ || other.planner != first.planner;
    has_profiles_ = has_profiles_ || other.profile != first.profile;
    has_probabilities_ = has_probabilities_ || other.probabilities != first.probabilities;
  }
}

std::vector<Column> ConfigurationColumns::columns() const {
  std::vector<Column> columns = has_switches() ? switch_columns() : std::vector<Column>();
  const auto add = [&columns](bool is_wanted, const char* title, const char* latex) {
    if (is_wanted) columns.push_back({"", title, "", latex, Align::kLeft});
  };
  add(has_planners_, "planner", "");
  add(has_profiles_, "profile", "");
  add(has_probabilities_, "initial P", "Initial $P_s$");
  return columns;
}

std::vector<Cell> ConfigurationColumns::cells(const Configuration& configuration) const {
  std::vector<Cell> cells =
      has_switches() ? switch_cells(configuration.switches) : std::vector<Cell>();
  if (has_planners_) cells.push_back({configuration.planner});
  if (has_profiles_) cells.push_back({configuration.profile});
  if (has_probabilities_) {
    const bool is_ideal = configuration.probabilities == Probabilities::kIdeal;
    cells.push_back({is_ideal ? "ideal" : "misspecified"});
  }
  return cells;
}

Column metric_column(Metric metric) {
  const MetricTraits& metric_traits = traits(metric);
  return {"", std::string(metric_traits.title), "", std::string(metric_traits.latex),
          Align::kRight};
}

std::string played(const std::string& planner, const std::string& profile) {
  return planner + " planner, " + profile + " profile";
}

std::string id_of(const std::string& table, const std::string& planner,
                  const std::string& profile) {
  return safe_id(table + "-" + planner + "-" + profile);
}

}  // namespace culprit::study
