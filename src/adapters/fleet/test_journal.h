// For tests: a journal as a robot's would be, written by the same writer.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "journal/writer.h"

namespace culprit::fleet {

inline constexpr const char* kFleetRules = R"(
ROBOT rover
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY restart 50 10
      ADAPTATION camera restart 2
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 2
)";

class TestJournal {
 public:
  explicit TestJournal(std::filesystem::path path) : path_(std::move(path)) {}

  const std::filesystem::path& path() const { return path_; }
  // A process of culprit begins. The rules are kFleetRules.
  // `wall` above 0: the manager tells incidents.
  void begins(const std::string& context = "", std::int64_t wall = 0);
  void ends();  // and lets go of the file
  void outcome(const std::string& strategy, bool has_helped);
  void event(const std::string& type, const std::string& more = "");
  void clock(std::int64_t wall) { wall_ = wall; }

 private:
  void append(std::string_view kind, const std::string& body);

  std::filesystem::path path_;
  std::optional<journal::Writer> writer_;
  std::int64_t wall_ = 1'800'000'000'000'000'000;
};

}  // namespace culprit::fleet
