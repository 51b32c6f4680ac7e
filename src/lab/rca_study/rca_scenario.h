// One scenario of the root-cause benchmark: a robot as a graph, its faults, its detectors and its
// repairs (docs/study-rca.md; as a file: scenario_json.h).
//
// The generated rules contain all that a manager may know (rules.h). The rest is hidden truth:
// which subscriptions pass failures on, how good the detectors are, and which repair helps against
// which fault.
//
// Which components are ill? A component with a fault that shows, one that an adaptation takes down, one that a common cause hits, and every component that an
// illness reaches: by one of its subscriptions, or, if they are redundant, by all of them. An illness that only feeds itself (a feedback loop) is none.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "language/rule_set.h"

namespace culprit::study::rca {

enum class FaultKind : std::uint8_t {
  kSilent,         // the node lives and sends nothing
  kSlow,           // it sends, too late: what depends on it notices late
  kDegraded,       // it sends nonsense
  kFlapping,       // silent and well in turns
  kCrash,          // its process is gone
  kHang,           // its process is there and answers nothing
  kWrongParameter  // somebody set a parameter wrong
};
inline constexpr std::size_t kFaultKinds = 7;
std::string_view to_string(FaultKind kind);  // "silent", "wrong_parameter"

// A repair of a component.
enum class Repair : std::uint8_t { kConfigure, kRestart, kRedeploy };
inline constexpr std::size_t kRepairs = 3;
std::string_view to_string(Repair repair);  // "configure", "restart", "redeploy"

struct Treatment {
  Repair repair = Repair::kRestart;
  double success = 50;                      // what the rules say, in percent
  double confidence = 10;                   // likewise
  int impact = 5;                           // likewise, in cycles
  double takes_s = 1;                       // from the request until it took effect
  std::array<double, kFaultKinds> helps{};  // the truth, by kind of fault: a probability
};

struct Detector {
  double latency_s = 0;  // from a change until readings show it
  double miss = 0;       // the probability that a reading of an ill component says that it is well
  double false_alarm = 0;           // and the other way round
  double false_alarms_per_min = 0;  // alarms of some seconds while it is well, in the mean
};

struct RcaComponent {
  std::string name;
  Criticality criticality = Criticality::kError;
  Detector detector;
  std::vector<Treatment> treatments;  // each repair at most once
  bool is_unwatched = false;          // no rule is about it
};

struct Subscription {
  std::size_t component = 0;
  double passes = 0;   // the probability that this subscription passes failures on, in an episode
  double delay_s = 0;  // until it does
  bool is_redundant = false;  // does so only together with all others like it of the component
  bool is_hidden = false;     // the graph does not show it
};

struct RcaTopic {
  std::string name;
  std::vector<std::size_t> publishers;
  std::vector<Subscription> subscribers;
  bool is_ignored = false;  // the rules say so (IGNORE TOPIC)
};

struct InjectedFault {
  std::size_t component = 0;
  FaultKind kind = FaultKind::kSilent;
  double at_s = 0;
  bool is_unfixable = false;  // nothing that the rules have helps against it
};

// A cause outside the robot, such as a network that is down: it makes two components ill for a while,
// and no repair of them helps.
struct CommonCause {
  std::size_t first = 0;
  std::size_t second = 0;
  double at_s = 0;
  double lasts_s = 0;
};

struct RcaScenario {
  std::uint64_t seed = 0;  // of all that is left to chance while it is played
  double reading_s = 0.2;  // between two readings of each detector
  double horizon_s = 120;  // after which it ends, well or not
  std::vector<RcaComponent> components;
  std::vector<RcaTopic> topics;
  std::vector<InjectedFault> faults;
  std::vector<CommonCause> common_causes{};
};

}  // namespace culprit::study::rca
