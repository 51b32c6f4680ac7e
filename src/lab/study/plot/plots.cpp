#include "study/plot/plots.h"

#include <algorithm>
#include <system_error>

#include "base/text_file.h"
#include "study/markup.h"
#include "study/plot/distribution_plot.h"
#include "study/plot/learning_plot.h"
#include "study/plot/style.h"

namespace culprit::study {
namespace {

// Curves of one failure, in the order in which failures occur.
std::vector<std::vector<LearningCurve>> by_failure(const std::vector<LearningCurve>& curves) {
  std::vector<std::vector<LearningCurve>> groups;
  for (const LearningCurve& curve : curves) {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& candidate) {
      return candidate.front().failure == curve.failure;
    });
    if (group == groups.end()) {
      groups.push_back({curve});
    } else {
      group->push_back(curve);
    }
  }
  return groups;
}

}  // namespace

std::vector<NamedPlot> plots(const Findings& findings) {
  std::vector<NamedPlot> plots;
  for (std::size_t i = 0; i < kMetricCount; ++i) {
    const auto metric = static_cast<Metric>(i);
    if (!has_values(findings.campaign, metric)) continue;
    plots.push_back({std::string(traits(metric).key), std::string(traits(metric).title),
                     std::string(traits(metric).explanation) +
                         " Bars are relative to the highest of their row.",
                     distribution_plot(findings.campaign, metric)});
  }
  for (const auto& curves : by_failure(findings.learning)) {
    plots.push_back({"learning-" + safe_id(curves.front().failure),
                     "learned success probabilities, " + curves.front().failure,
                     "Strategies of " + curves.front().rule + ".", learning_plot(curves)});
  }
  return plots;
}

Expected<void> write_plots(const Findings& findings, const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) return Error{folder.string() + ": the folder cannot be made: " + problem.message()};
  const std::string style = plot_style(ColorScheme::kLight);
  for (const NamedPlot& plot : plots(findings)) {
    const std::filesystem::path path = folder / (plot.id + ".svg");
    if (const auto written = write_text(path, plot.svg.file(style)); !written) return written;
  }
  return {};
}

}  // namespace culprit::study
