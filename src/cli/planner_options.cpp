#include "cli/planner_options.h"

#include "plan/paper_planner.h"

namespace culprit::cli {

void PlannerOptions::add_to(CLI::App& command) {
  const std::string kFactors = "The paper's factors";
  command
      .add_flag("--no-dependencies", no_dependencies,
                "Do not look for root causes in the dependency graph")
      ->group(kFactors);
  command.add_flag("--no-criticality", no_criticality, "Treat all failures as equally critical")
      ->group(kFactors);
  command.add_flag("--no-impact", no_impact, "Do not count a strategy's impact as cost")
      ->group(kFactors);
}

std::unique_ptr<const Planner> PlannerOptions::planner() const {
  return std::make_unique<PaperPlanner>(
      PaperSwitches{!no_dependencies, !no_criticality, !no_impact});
}

}  // namespace culprit::cli
