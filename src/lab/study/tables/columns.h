// Shared columns of a study's tables.
#pragma once

#include <string>
#include <vector>

#include "study/campaign_result.h"
#include "study/published.h"
#include "study/tables/table.h"

namespace culprit::study {

// "0.75"; a rounded zero has no sign. "–" for what is no number.
std::string number(double value, int decimals = 2);
// "0.75 ± 0.20"; "–" of no values.
std::string mean_sd(const Summary& summary);
std::string mean_sd(const published::MeanSd& value);
// "< 0.001", "0.034".
std::string p_value(double p);

// D, C, S as the paper marks them.
std::vector<Column> switch_columns();
std::vector<Cell> switch_cells(const PaperSwitches& switches);

// The columns that distinguish the campaign's rows. The switches are among them unless only planners
// differ, most of which have none.
class ConfigurationColumns {
 public:
  explicit ConfigurationColumns(const std::vector<Row>& rows);
  std::vector<Column> columns() const;
  std::vector<Cell> cells(const Configuration& configuration) const;
  bool has_switches() const { return has_switches_ || !has_planners_; }

 private:
  bool has_switches_ = false;
  bool has_planners_ = false;
  bool has_profiles_ = false;
  bool has_probabilities_ = false;
};

Column metric_column(Metric metric);

// "paper planner, paper profile", for captions.
std::string played(const std::string& planner, const std::string& profile);

// The id of a table of which there is one for each planner and profile: "effects-paper-paper".
std::string id_of(const std::string& table, const std::string& planner, const std::string& profile);

}  // namespace culprit::study
