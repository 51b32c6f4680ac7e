// What the rules want to know, picked out of diagnostic messages.
//
// A declared signal names a status, by its name or its hardware id, and a key. One that is only
// used is looked for as a key of its name, or as "<hardware id>_<key>" or "<status name>_<key>"
// (the convention of the SUNSET exemplar's blackboard).
#pragma once

#include <functional>
#include <string>
#include <unordered_map>

#include "language/rule_set.h"
#include "ros2/messages.h"

namespace culprit::ros2 {

class DiagnosticsReading {
 public:
  explicit DiagnosticsReading(const RuleSet& rules);

  // Whether the rules read any diagnostic.
  bool is_wanted() const { return !signals_.empty() || !levels_.empty(); }

  std::function<void(SignalId, const std::string& text)> on_signal;
  std::function<void(DiagnosticId, std::uint8_t level)> on_level;

  // Calls the two above for what the rules want of `message`.
  void read(const msg::DiagnosticArray& message) const;

 private:
  void read(const msg::DiagnosticStatus& status) const;
  void read_named(const std::string& name, const msg::DiagnosticStatus& status) const;
  void read(const std::string& name, const std::string& text) const;

  std::unordered_map<std::string, SignalId> signals_;     // by "status\nkey", or by the bare name
  std::unordered_map<std::string, DiagnosticId> levels_;  // by name or hardware id
};

}  // namespace culprit::ros2
