// Which component was responsible for what is wrong in a recording: symptoms, joined by the graph, as incidents.
//
// The diagnosis is that of the live robot (diagnose/): each symptom is a failure of the node that publishes its topic, with
// the onset that the recording shows; topics that go on normally are evidence that their nodes are well. A symptom is
// looked at together with those that began at most kLongestWay before it and were not over by then. Without a graph each
// symptom is an incident of its own.
#pragma once

#include <string>
#include <vector>

#include "bag_doctor/robot_graph.h"
#include "bag_doctor/symptom.h"

namespace culprit::bag_doctor {

inline constexpr Duration kLongestWay = std::chrono::seconds(30);
// Words (logs, diagnostics) explain only what follows soon: many nodes log errors and work.
inline constexpr Duration kWordsReach = std::chrono::seconds(5);

struct BagIncident {
  std::string cause;       // a node; or the topic where its publisher is unknown
  bool is_node = false;    // the cause is known to be a node
  bool is_unseen = false;  // nothing of it was recorded: only what depends on it is wrong
  double certainty = 1;    // the probability that it has a cause of its own
  Onset onset{};
  Time until{};
  std::vector<std::size_t> own{};      // symptoms of the cause, by onset
  std::vector<std::size_t> effects{};  // symptoms of others, by onset
};

// The component of each symptom: a node; or its topic, or what the finding is about, where the node is unknown.
struct Owner {
  std::string name;
  bool is_node = false;
};
std::vector<Owner> owners_of(const std::vector<Symptom>& symptoms, const RobotGraph& graph);

// The worst first; of equals the one with the most effects, then the earliest. Each symptom is in one of them.
std::vector<BagIncident> incidents_of(const std::vector<Symptom>& symptoms,
                                      const std::vector<Health>& health, const RobotGraph& graph);

// Topics of symptoms whose publisher is unknown, sorted.
std::vector<std::string> without_publisher(const std::vector<Symptom>& symptoms,
                                           const RobotGraph& graph);

}  // namespace culprit::bag_doctor
