// The doctor's whole report on a recording: for a terminal, for programs.
//
//     ros2::MessageLibrary library;
//     const auto course = read_course("my_bag", library);
//     const BagReport report = report_of(*course, graph);
//     for (const doctor::Finding& each : report.findings) print(each);      // the cause first, then its effects
#pragma once

#include <string>
#include <vector>

#include "bag_doctor/bag_incident.h"
#include "bag_doctor/recording_course.h"
#include "doctor/finding.h"
#include "json/json.h"

namespace culprit::bag_doctor {

struct BagReport {
  std::string path;
  Nanoseconds begin = 0;
  Duration length{};
  std::uint64_t messages = 0;
  std::size_t topics = 0;
  struct Incident {
    std::string cause;
    bool is_node = false;
    double certainty = 1;
    doctor::When when{};
    std::vector<std::string> effects{};  // components, by onset
    std::size_t first = 0, count = 0;    // its findings
  };
  std::vector<Incident> incidents{};
  std::vector<doctor::Finding> findings{};  // by incident: its cause, what shows it, its effects
  std::vector<std::string> left_out{};      // what is not known, in sentences
};

// `graph` beside what was recorded of it.
BagReport report_of(const BagCourse& course, const RobotGraph& graph);

// {bag, begin, length_s, messages, topics, incidents: [{cause, known, certainty, from_s, until_s, clock, effects,
// findings: [index]}], findings, left_out}
Json to_json(const BagReport& report);

// "my_bag, 60.0 s, 12 topics: 1 error, 2 warnings".
std::string summary(const BagReport& report);

}  // namespace culprit::bag_doctor
