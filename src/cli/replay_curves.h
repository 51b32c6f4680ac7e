// culprit replay JOURNAL --curve NAME ... --since 2h [--until 1h]: what the rules read then, as a table.
#pragma once

#include <string>
#include <vector>

#include "journal/reader.h"

namespace culprit::cli {

struct CurveOptions {
  std::vector<std::string> names;
  std::string since;
  std::string until;
  bool json = false;
};

// Prints the table, or one JSON document. Gives the exit code.
int replay_curves(const CurveOptions& options, const journal::Reader& journal);

}  // namespace culprit::cli
