// The outcome of one play of a demonstration.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace culprit::lab {

// How one play went. Times are seconds on the clock.
struct PlayOutcome {
  std::string name;
  std::vector<std::string> faults;
  std::vector<std::string> failures;
  std::vector<std::string> strategies;  // executed, in their order
  int strategies_succeeded = 0;
  int unnecessary_redeployments = 0;
  std::vector<double> reaction_times;
  double downtime = 0;  // SUNSET: of the segmentation, open gaps included; the rover: it stood
  std::optional<double> mean_iou;          // SUNSET
  std::optional<double> healed_s{};        // the rover: from the fault until it was well
  int goals = 0;                           // the rover: reached meanwhile
  int collisions = 0;                      // the rover
  std::optional<double> stands_after_s{};  // the rover: from the fault until it stood, for a person
  std::size_t unresolved = 0;              // failures
  std::vector<std::string> blamed{};       // components that an incident held responsible
  std::vector<std::string> redeployed{};   // components, in their order
  int calls = 0;                           // for a person
  bool is_for_a_person = false;            // no strategy helps, and the robot is to stand
  std::string complaint;                   // what is still wrong with the robot; empty: nothing
  bool is_resolved() const { return unresolved == 0 && complaint.empty(); }
};

}  // namespace culprit::lab
