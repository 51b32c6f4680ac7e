// The doctor's whole report on a robot: for a terminal, for programs, for the page.
//
//     const auto picture = doctor::look({.participant = options});
//     const doctor::Report report = doctor::report_of(*picture);
//     std::cout << doctor::to_indented(to_json(report));
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/units.h"
#include "doctor/baseline.h"
#include "doctor/finding.h"
#include "doctor/picture.h"
#include "json/json.h"

namespace culprit::doctor {

struct Report {
  std::uint32_t domain = 0;
  std::size_t nodes = 0;
  Duration looked{};
  std::vector<Finding> findings;      // the worst first
  std::vector<std::string> left_out;  // what was not looked at, in sentences
  // Findings that are not among them, since the doctor may only have been too late to hear (held_up.h).
  std::vector<Finding> doubtful{};
  bool operator==(const Report&) const = default;
};

// `healthy`: what the robot is compared with, too; null: nothing.
Report report_of(const Picture& picture, const Baseline* healthy = nullptr);

// {code, severity, who, nodes, topic, seen, matters, remedy}; of a recording also from_s, until_s (seconds since its
// beginning) and clock (seconds since 1970).
Json to_json(const Finding& finding);

// {domain, nodes, looked_s, findings: [{code, severity, who, nodes, topic, seen, matters, remedy}],
// left_out}.
Json to_json(const Report& report);

// SARIF 2.1.0 (OASIS), one run. Every code is a rule, found or not; who is concerned are logical
// locations.
Json to_sarif(const Report& report);

// "12 nodes on domain 7: 1 error, 2 warnings". Where there is a doubt, it says so instead of that nothing is wrong.
std::string summary(const Report& report);

}  // namespace culprit::doctor
