// Reads the rules' signals out of /diagnostics.
//
// A declared signal names a status, by its name or its hardware id, and a key. One that is only
// used is looked for as a key of its name, or as "<hardware id>_<key>" or "<status name>_<key>"
// (the convention of the SUNSET exemplar's blackboard).
#pragma once

#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "language/rule_set.h"
#include "robot/inbox.h"
#include "ros2/messages.h"
#include "ros2/subscription.h"

namespace culprit::ros2 {

class DiagnosticsWatch {
 public:
  // Subscribes if the rules read any diagnostic. All references must outlive the watch.
  static Expected<std::unique_ptr<DiagnosticsWatch>> create(NodeEntry& self, const RuleSet& rules,
                                                            Inbox& inbox);

 private:
  DiagnosticsWatch(NodeEntry& self, const RuleSet& rules, Inbox& inbox);
  void on_sample(const Sample& sample);
  void read(const msg::DiagnosticStatus& status);
  void read_named(const std::string& name, const msg::DiagnosticStatus& status);
  void read(DiagnosticId diagnostic, std::uint8_t level);
  void read(const std::string& name, const std::string& text);

  NodeEntry& self_;
  Inbox& inbox_;
  std::unordered_map<std::string, SignalId> signals_;     // by "status\nkey", or by the bare name
  std::unordered_map<std::string, DiagnosticId> levels_;  // by name or hardware id
  // What was read last, by signal and by diagnostic.
  std::unordered_map<std::uint32_t, std::string> last_;
  std::unordered_map<std::uint32_t, std::uint8_t> last_level_;
  std::unique_ptr<RawSubscription> subscription_;
};

}  // namespace culprit::ros2
