// Defects of a recording, found without rules: the doctor's findings, each with the time from which it is there.
//
// A finding of gravity kError is a claim that something failed. It is made only where no innocent explanation is left: a
// topic on demand, a latched topic, a burst, a late start by design, and the recorder's own start and end are none.
#pragma once

#include <string>
#include <vector>

#include "bag_doctor/recording_course.h"
#include "doctor/finding.h"
#include "knowledge/onset.h"

namespace culprit::bag_doctor {

struct Symptom {
  enum class Kind : std::uint8_t {
    kOutage,  // messages do not come, or too few
    kValue,   // they carry something wrong
    kState,   // a node left its active state
    kWords    // a node or a diagnostic says so itself
  };
  Kind kind = Kind::kOutage;
  doctor::Finding finding;  // without `when`
  std::string topic{};      // that shows it; empty: none
  std::string node{};       // that it is about, where the recording says so itself
  std::string status{};     // the diagnostic status that shows it; empty: none
  Onset onset{};            // when it began
  Time until = kNever;      // when it was over; kNever: not in this recording
  std::string words{};      // short, after the node's name: "fell silent on /scan"
};

// By onset.
std::vector<Symptom> symptoms_of(const BagCourse& course);

// Topics that carry on normally all the time: their publishers are well.
struct Health {
  std::string topic;
  bool has_values = false;  // their values were examined, too
};
std::vector<Health> healthy_topics(const BagCourse& course, const std::vector<Symptom>& symptoms);

// The node that a status is about, by the habit of diagnostic_updater: "camera: frame rate" is of /camera, or else of
// /robot1/camera. Empty: none of `nodes` is called so, or several of different namespaces are.
std::string node_of_status(const std::string& status, const std::set<std::string>& nodes);

}  // namespace culprit::bag_doctor
