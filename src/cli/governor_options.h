// How much culprit may do on its own: the switches of the governor (docs/governor.md).
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "execute/governor.h"
#include "json/json.h"

namespace culprit::cli {

struct GovernorOptions {
  bool approve = false;
  double quiet_seconds = 0;
  std::string overall;  // "20/1min"; "none"
  std::string per_kind;
  std::string per_component;
  std::string restarts;
  double backoff_seconds = 0;
  double backoff_most_seconds = 0;
  double healthy_seconds = 0;
  int storm_percent = 0;
  bool no_evidence = false;
  bool revive = false;

  GovernorOptions();  // as recommended

  // The options must live as long as `command`.
  void add_to(CLI::App& command);
  // An error: an intensity that is none.
  Expected<Governor::Options> options() const;

  // For the journal. A missing field has the recommended value, but `restarts` is unlimited.
  Json to_json() const;
  static GovernorOptions from_json(const Json& json);
};

}  // namespace culprit::cli
