// The fleet that `culprit run --fleet` joins.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "base/expected.h"
#include "live/fleet.h"

namespace culprit::cli {

struct FleetOptions {
  std::string address;  // of its database; empty: there is no fleet
  std::string name;     // of the robot; empty: the computer's
  std::string context;

  // --fleet, --fleet-name, --fleet-context. The options must live as long as `command`.
  void add_to(CLI::App& command);
};

// Null: there is none. Errors: the address is none, or this culprit knows no fleets.
Expected<std::unique_ptr<live::Fleet>> join_fleet(const FleetOptions& options,
                                                  const std::filesystem::path& journal);

}  // namespace culprit::cli
