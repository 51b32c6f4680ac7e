// The events on the robot in a test, and its answers: the part of a test that is played.
//
// Times count from the start of the test.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "language/rule_set.h"
#include "robot/observation.h"

namespace culprit::rule_test {

// Something that the manager reads and that has a course over time.
using Subject = std::variant<TopicId, SignalId, DiagnosticId, ParameterId>;

// A stretch of a course. Where stretches overlap, the one that was written last counts.
struct Stretch {
  Duration from{};
  std::optional<Duration> until;  // nothing: without end
  std::optional<Value> value;     // a topic's is its rate in Hz; nothing: silent
};

struct Course {
  Subject subject;
  std::vector<Stretch> stretches;
  std::optional<Duration> period;  // how often a signal or a level is read
};

// Consumers and producers of the graph, by component.
struct Endpoint {
  ComponentId component;
  EndpointKind kind;
  std::string name;  // of the topic or the service
};
// `consumer` cannot work without `producer`, and depends on it in the graph.
struct Need {
  ComponentId consumer;
  ComponentId producer;
};
// `subject` is published by `component` alone: it is silent while the component does not work.
struct Origin {
  ComponentId component;
  Subject subject;
};

enum class Presence : std::uint8_t { kThere, kAbsent };
// How a component is at the start, and when it was started anew. kUnknown: it has no lifecycle.
struct InitialState {
  ComponentId component;
  Presence presence = Presence::kThere;
  Lifecycle lifecycle = Lifecycle::kActive;
};

// A goal that the server of an action pursues.
struct GoalCourse {
  TopicId topic;  // of its status
  Duration from{};
  std::optional<Duration> until;  // nothing: it goes on
  GoalStatus outcome = GoalStatus::kUnknown;
};

// Lines that a component writes into its log: one at `from`, and if `until` is given one each kLogPeriod before that.
inline constexpr Duration kLogPeriod = std::chrono::milliseconds(100);
struct LogCourse {
  ComponentId component;
  LogLevel level = LogLevel::kError;
  Duration from{};
  std::optional<Duration> until;
};

struct Incident {
  enum class Kind : std::uint8_t {
    kKilled,   // its process ends
    kStopped,  // its process exists and does nothing (SIGSTOP)
    kHung,     // its process runs, and it does nothing and answers nothing
    kState     // its lifecycle changes
  };
  Duration at{};
  ComponentId component;
  Kind kind = Kind::kKilled;
  Lifecycle lifecycle = Lifecycle::kUnknown;  // kState
};

// How the robot answers an adaptation.
struct Answer {
  StrategyId strategy;
  std::size_t adaptation = 0;  // index in Strategy::adaptations
  enum class Manner : std::uint8_t { kObeys, kRefuses, kNeverAnswers };
  std::optional<Manner> manner;
  std::optional<Duration> takes;
};

// `subjects` are as they were at the start again once all adaptations of `strategy`, or only
// `adaptation`, took effect.
struct Cure {
  StrategyId strategy;
  std::optional<std::size_t> adaptation;
  Duration after{};
  std::vector<Subject> subjects;
};

struct Scenario {
  std::vector<Course> courses;
  std::vector<Endpoint> endpoints;
  std::vector<Need> needs;
  std::vector<Origin> origins;
  std::vector<InitialState> states;
  std::vector<Incident> incidents;
  std::vector<GoalCourse> goals;
  std::vector<LogCourse> logs;
  std::vector<Answer> answers;
  std::vector<Cure> cures;

  // The statements of `other` follow these.
  void append(const Scenario& other);
};

}  // namespace culprit::rule_test
