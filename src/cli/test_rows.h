// For live tests: when culprit did what, by its journal, which no waiting of the test distorts.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/units.h"

namespace culprit::cli {

// One row for people of the journal: a finding, a decision, a request, its outcome.
struct Row {
  std::chrono::nanoseconds at{};  // since 1970
  std::string kind;               // as journal::kind says
  std::string text;               // "lidar: stop process"
};

class Rows {
 public:
  // All that the journal has by now. The test fails if it cannot be read.
  explicit Rows(const std::filesystem::path& journal);

  // The first that says so, after the row `after` if there is one; nothing if none does.
  std::optional<Row> first(const std::string& text, const std::optional<Row>& after = {}) const;
  // How often exactly that was asked for.
  std::size_t requests(const std::string& text) const;
  // All, one a line, to find out why a test failed.
  std::string all() const;

 private:
  std::vector<Row> rows_;
};

}  // namespace culprit::cli
