// What a recorded bag would have told a manager: the rhythm of topics, values of their fields,
// diagnostics, parameters and lifecycle states.
//
// A bag does not say which node published what, nor which processes ran. So nodes are known from
// what they say of themselves only (/parameter_events, ~/transition_event, /rosout), nobody says
// when one is gone, and dependencies come from the rule file.
#pragma once

#include <unordered_map>
#include <vector>

#include "bag/bag_contents.h"
#include "language/rule_set.h"
#include "link/diagnostics_reading.h"
#include "robot/component_binding.h"
#include "robot/observation.h"
#include "ros2/field_reader.h"

namespace culprit::bag {

class BagReading {
 public:
  // All must outlive the reading. Types are first looked for in the bag, then in `library`.
  BagReading(const RuleSet& rules, const BagContents& contents, ros2::MessageLibrary& library);
  BagReading(const BagReading&) = delete;

  // Appends what the rules want of `message`.
  void read(const BagMessage& message, std::vector<Observation>& observations);

  // What the rules read and the bag, as far as it was read, does not have: one line each.
  std::vector<std::string> missing() const;

 private:
  enum class Use : std::uint8_t { kNone, kDiagnostics, kParameters, kTransition, kLog };
  struct Field {
    SignalId signal;
    ros2::FieldReader reader;
  };
  struct Plan {
    Use use = Use::kNone;
    std::string node;  // kTransition
    std::optional<TopicId> topic;
    std::vector<Field> fields;
  };

  Plan plan_for(const BagTopic& topic);
  void plan_fields(const BagTopic& topic, Plan& plan);
  void read_parameters(ros2::ByteView payload);
  void read_transition(const std::string& node, ros2::ByteView payload);
  void read_log(ros2::ByteView payload);
  std::optional<ComponentId> node_seen(const std::string& node);
  void put(ObservationWhat what);

  const RuleSet& rules_;
  const BagContents& contents_;
  ros2::MessageLibrary& library_;
  ros2::DiagnosticsReading diagnostics_;
  ComponentBinding binding_;
  std::unordered_map<std::string, std::optional<ComponentId>> nodes_;
  std::unordered_map<std::string, std::string> loggers_;  // to the nodes of components
  std::vector<Plan> plans_;                               // by topic of the bag
  std::vector<std::string> unreadable_;                   // signals
  Time now_{};
  std::vector<Observation>* out_ = nullptr;  // while reading
};

}  // namespace culprit::bag
