// Which planner decides, and how: the same switches for every command that plans.
#pragma once

#include <memory>

#include <CLI/CLI.hpp>

#include "plan/planner.h"

namespace culprit::cli {

struct PlannerOptions {
  bool no_dependencies = false;
  bool no_criticality = false;
  bool no_impact = false;

  // The options must live as long as `command`.
  void add_to(CLI::App& command);
  std::unique_ptr<const Planner> planner() const;
};

}  // namespace culprit::cli
