#include "terminal/planner_options.h"

#include "journal/json.h"
#include "json/json.h"
#include "plan/bayes/bayes_planner.h"
#include "plan/paper_planner.h"

namespace culprit {

void PlannerOptions::add_to(CLI::App& command) {
  command
      .add_option("--planner", name,
                  "bayes: the most likely root cause, and the most valuable strategies;\n"
                  "paper: Algorithm 1 of the paper")
      ->check(CLI::IsMember({"bayes", "paper"}))
      ->capture_default_str();
  CLI::Option* wish =
      command.add_option("--objective", objective, "Cost that the bayes planner minimizes")
          ->check(CLI::IsMember({"balanced", "downtime", "adaptations", "redeployments"}))
          ->capture_default_str();
  const std::string kFactors = "The paper planner's factors";
  const auto factor = [&](const char* flag, bool& value, const char* help) {
    return command.add_flag(flag, value, help)->group(kFactors);
  };
  factor("--no-dependencies", no_dependencies, "Ignore the dependency graph");
  factor("--no-criticality", no_criticality, "Ignore the criticality of failures");
  factor("--no-impact", no_impact, "Ignore the impact of strategies");
  command.parse_complete_callback([this, wish] {
    const bool has_factor = no_dependencies || no_criticality || no_impact;
    if (has_factor && name != "paper")
      throw CLI::ValidationError(
          "--no-dependencies, --no-criticality and --no-impact are of the paper's planner; add "
          "--planner paper");
    if (wish->count() > 0 && name != "bayes")
      throw CLI::ValidationError("--objective is of the bayes planner; leave out --planner paper");
  });
}

std::unique_ptr<const Planner> PlannerOptions::planner() const {
  if (name == "paper")
    return std::make_unique<PaperPlanner>(
        PaperSwitches{!no_dependencies, !no_criticality, !no_impact});
  return std::make_unique<BayesPlanner>(*parse_objective(objective));
}

PlannerFactory PlannerOptions::factory() const {
  return [options = *this] { return options.planner(); };
}

Json PlannerOptions::to_json() const {
  return {{"name", name},
          {"objective", objective},
          {"no_dependencies", no_dependencies},
          {"no_criticality", no_criticality},
          {"no_impact", no_impact}};
}

Expected<PlannerOptions> PlannerOptions::from_json(const Json& json) {
  PlannerOptions options;
  options.name = journal::text_of(json, "name");
  options.objective = journal::text_of(json, "objective");
  options.no_dependencies = journal::flag_of(json, "no_dependencies");
  options.no_criticality = journal::flag_of(json, "no_criticality");
  options.no_impact = journal::flag_of(json, "no_impact");
  const bool is_known = options.name == "bayes" || options.name == "paper";
  if (!is_known || !parse_objective(options.objective))
    return Error{"it was recorded with a planner that this culprit does not have"};
  return options;
}

}  // namespace culprit
