// The parts of the robot that were ever seen: in this run, or in an earlier one on the same robot.
//
// An absent node has not failed. A name that was never seen may be one that no robot has, or a node that comes
// later: triggers read it as unknown, so nothing is done about it.
//
//   a component  was seen once its node was in the graph;
//   a topic      was seen once a node published it, or a message came on it.
//
// Also the messages and values that were received, for the next run (known_robot.h).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/time.h"
#include "language/rule_set.h"

namespace culprit {

class Discovered {
 public:
  explicit Discovered(const RuleSet& rules)
      : components_(rules.components.size()),
        topics_(rules.topics.size()),
        received_(rules.topics.size()),
        signals_(rules.signals.size()),
        diagnostics_(rules.diagnostics.size()),
        parameters_(rules.parameters.size()),
        lifecycles_(rules.components.size()) {}

  // The time since when it is known. If only an earlier run saw it: since this one began.
  std::optional<Time> first(ComponentId id) const { return components_[id.index]; }
  std::optional<Time> first(TopicId id) const { return topics_[id.index]; }
  bool has(ComponentId id) const { return components_[id.index].has_value(); }
  bool has(TopicId id) const { return topics_[id.index].has_value(); }

  // Gives whether it was seen for the first time.
  bool note(ComponentId id, Time at) { return note(components_[id.index], at); }
  bool note(TopicId id, Time at) { return note(topics_[id.index], at); }

  // The node that publishes a diagnostic status, by status (PublisherKnown).
  const std::map<std::string, std::string>& publishers() const { return publishers_; }
  void note_publisher(const std::string& status, const std::string& node) {
    constexpr std::size_t kMost = 1000;  // earlier rules may have named others
    if (publishers_.size() >= kMost && !publishers_.contains(status)) return;
    if (std::exchange(publishers_[status], node) != node) ++count_;
  }

  // Another number whenever something was seen for the first time.
  std::size_t count() const { return count_; }

  // A message came, or a value.
  void receive(TopicId id) { mark(received_, id.index); }
  // Its publisher left, or is another process.
  void forget_received(TopicId id) {
    if (received_[id.index]) ++received_count_;
    received_[id.index] = false;
  }
  void read(SignalId id) { mark(signals_, id.index); }
  void read(DiagnosticId id) { mark(diagnostics_, id.index); }
  void read(ParameterId id) { mark(parameters_, id.index); }
  void read_lifecycle(ComponentId id) { mark(lifecycles_, id.index); }
  bool was_received(TopicId id) const { return received_[id.index]; }
  bool was_read(SignalId id) const { return signals_[id.index]; }
  bool was_read(DiagnosticId id) const { return diagnostics_[id.index]; }
  bool was_read(ParameterId id) const { return parameters_[id.index]; }
  bool was_lifecycle_read(ComponentId id) const { return lifecycles_[id.index]; }

  // There was time to see what there is.
  void complete() {
    if (!std::exchange(is_whole_, true)) ++received_count_;
  }
  bool is_whole() const { return is_whole_; }

  // Another number whenever one of these became true, or ceased to be.
  std::size_t received_count() const { return received_count_; }

 private:
  void mark(std::vector<bool>& marks, std::size_t place) {
    if (marks[place]) return;
    marks[place] = true;
    ++received_count_;
  }

  bool note(std::optional<Time>& first, Time at) {
    if (first) return false;
    first = at;
    ++count_;
    return true;
  }

  std::vector<std::optional<Time>> components_;
  std::vector<std::optional<Time>> topics_;
  std::map<std::string, std::string> publishers_;
  std::size_t count_ = 0;
  std::vector<bool> received_;
  std::vector<bool> signals_;
  std::vector<bool> diagnostics_;
  std::vector<bool> parameters_;
  std::vector<bool> lifecycles_;
  bool is_whole_ = false;
  std::size_t received_count_ = 0;
};

}  // namespace culprit
