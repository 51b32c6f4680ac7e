// All plots of a study.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/expected.h"
#include "study/findings.h"
#include "study/plot/svg.h"

namespace culprit::study {

struct NamedPlot {
  std::string id;  // of letters, digits, dashes and underscores: "downtime_s", "learning-F1"
  std::string title;
  std::string caption;  // sentences
  Svg svg;
};

// A distribution of each metric that has values, and the learning curves of each failure.
std::vector<NamedPlot> plots(const Findings& findings);

// Writes each plot as <id>.svg into the folder, which is made if it is not there. In the colours of
// light scheme: for papers.
Expected<void> write_plots(const Findings& findings, const std::filesystem::path& folder);

}  // namespace culprit::study
