// The folder of a drill: from it a drill is resumed, reported on, and replayed.
//
//     drill.json       the rules, the plan, and the healthy robot
//     trials.jsonl     a line for each fault, appended when it is over
//     robot.journal    of the culprit that healed (culprit replay plays it)
//     culprit.log      what it printed
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/expected.h"
#include "drill/robot_view.h"

namespace culprit::drill {

struct DrillHead {
  std::string rules;              // their text
  std::vector<std::string> plan;  // the ids of its steps, in order
  HealthyRobot healthy{};
};

class DrillRecord {
 public:
  // Makes the folder, or opens one of the same rules and plan, whose trials are then known. Errors: it holds another
  // drill, or cannot be written.
  static Expected<DrillRecord> open(const std::filesystem::path& folder, const DrillHead& head);

  const std::vector<Trial>& trials() const { return trials_; }
  // Whether the step is done: a trial that proves nothing is tried again.
  bool has(const std::string& id) const;
  const DrillHead& head() const { return head_; }
  std::filesystem::path file(const char* name) const { return folder_ / name; }

  Expected<void> keep(HealthyRobot healthy);
  // On the disk when this returns.
  Expected<void> add(const Trial& trial);

 private:
  DrillRecord(std::filesystem::path folder, DrillHead head)
      : folder_(std::move(folder)), head_(std::move(head)) {}
  Expected<void> write_head() const;

  std::filesystem::path folder_;
  DrillHead head_;
  std::vector<Trial> trials_;
};

// Lines that are cut or of anything else are left out.
std::vector<Trial> trials_in(const std::string& text);

}  // namespace culprit::drill
