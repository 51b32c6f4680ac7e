// A recorded bag as observations for a manager: the rhythm of topics, values of their fields,
// diagnostics, parameters, lifecycle states and goals of actions.
//
// A bag does not say which node published what, nor which processes ran. So nodes are known from
// what they say of themselves only (/parameter_events, ~/transition_event, /rosout), nobody says
// when one is gone, and dependencies come from the rule file.
//
// A message that cannot be decoded makes the values that rules read of it unknown
// (robot/unreadable.h). It is decoded from its beginning to its end, so that a definition that does
// not fit is noticed, too.
#pragma once

#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "bag/bag_contents.h"
#include "language/rule_set.h"
#include "link/diagnostics_reading.h"
#include "link/log_watch.h"
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

  // Why the input had no value in the bag, as far as it was read, and never could have one: "no
  // message of /scan was recorded". Empty: it had one, or its window was never covered.
  std::string why_unknown(InputId input) const;

  // Whether the input has a value that says nothing about the robot: what it is about is not recorded,
  // or the rule compares a number with a text. why_unknown() says why.
  bool is_misread(InputId input) const;

  // The inputs of the rules that the bag, as far as it was read, does not have: one line each.
  std::vector<std::string> missing() const;

  // The topics with messages that cannot be decoded, one line each.
  std::vector<std::string> undecoded() const;

 private:
  enum class Use : std::uint8_t { kNone, kDiagnostics, kParameters, kTransition, kLog, kGoals };
  struct Field {
    SignalId signal;
    ros2::FieldReader reader;
  };
  struct Plan {
    Use use = Use::kNone;
    std::string node{};  // kTransition
    std::optional<TopicId> topic{};
    std::vector<Field> fields{};
    std::optional<ros2::FieldReader> whole{};
    std::uint64_t messages = 0;
    std::uint64_t undecoded = 0;
    std::string why_undecoded{};  // the first of them
  };
  // The readings of a signal so far.
  struct SignalSeen {
    bool was_read = false;
    bool was_usable = false;       // once at least, by the type that the rules read
    bool is_number = false;        // the field is one
    std::string example{};         // a value that is not usable
    std::string why_unreadable{};  // its field is not there, or its messages are not in CDR
  };

  Plan plan_for(const BagTopic& topic);
  void plan_fields(const BagTopic& topic, Plan& plan);
  bool decodes(Plan& plan, const BagTopic& topic, rtps::ByteView payload);
  template <class Message>
  std::optional<Message> decoded(Plan& plan, const BagTopic& topic, rtps::ByteView payload);
  void note_undecoded(Plan& plan, const BagTopic& topic, bool is_longer);
  void read_fields(const Plan& plan, rtps::ByteView payload, bool is_decoded);
  void read_parameters(const ros2::msg::ParameterEvent& event);
  void read_transition(const std::string& node, const ros2::msg::TransitionEvent& event);
  void read_log(const ros2::msg::Log& log);
  void count_log(std::optional<ComponentId> component, const ros2::msg::Log& log);
  void read_signal(SignalId signal, Value value);
  std::optional<ComponentId> node_seen(const std::string& node);
  void put(ObservationWhat what);

  std::uint64_t messages_of(const std::string& topic) const;
  std::string why_no_topic(TopicId topic) const;
  bool is_compared_with_text(SignalId signal) const;
  std::string why_no_signal(SignalId signal) const;
  std::string why_no_status(const std::string& status) const;
  std::string why_no_component(ComponentId component) const;
  std::string why_no_lifecycle(ComponentId component) const;
  std::string why_no_parameter(ParameterId parameter) const;
  bool has_type(std::string_view type) const;

  const RuleSet& rules_;
  const BagContents& contents_;
  ros2::MessageLibrary& library_;
  link::DiagnosticsReading diagnostics_;
  ComponentBinding binding_;
  std::unordered_map<std::string, std::optional<ComponentId>> nodes_;
  std::unordered_map<std::string, std::string> loggers_;  // to the nodes of components
  std::vector<Plan> plans_;                               // by topic of the bag
  std::vector<SignalSeen> signals_;
  std::vector<bool> levels_;                           // by diagnostic: it was read
  std::vector<bool> components_;                       // its node was seen
  std::vector<bool> lifecycles_;                       // its state was read
  std::vector<bool> parameters_;                       // it was read
  std::vector<std::optional<LogLevel>> counted_logs_;  // by component: the least that rules count
  std::unordered_set<std::string> statuses_;  // names and hardware ids, of many the first ones
  Time now_{};
  std::int64_t recorded_at_ = 0;
  std::vector<Observation>* out_ = nullptr;  // while reading
};

}  // namespace culprit::bag
