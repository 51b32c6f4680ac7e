// Which planner decides, and how: the same switches for every command that plans
// (docs/planning.md).
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "base/expected.h"
#include "json/json.h"
#include "plan/planner.h"

namespace culprit {

struct PlannerOptions {
  std::string name = "bayes";
  std::string objective = "balanced";
  bool no_dependencies = false;
  bool no_criticality = false;
  bool no_impact = false;

  // The options must live as long as `command`. A switch of another planner than the one that is
  // asked for is a usage error.
  void add_to(CLI::App& command);
  std::unique_ptr<const Planner> planner() const;
  PlannerFactory factory() const;

  // For the journal. Errors: the planner or its objective is not known.
  Json to_json() const;
  static Expected<PlannerOptions> from_json(const Json& json);
};

}  // namespace culprit
