// Reads the rules' signals out of /diagnostics. What comes there may be 100 ms late (participant.h): many nodes say there again
// and again what has not changed.
#pragma once

#include <memory>
#include <string>
#include <unordered_map>

#include "link/diagnostics_reading.h"
#include "robot/inbox.h"
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
  void on_level(DiagnosticId diagnostic, std::uint8_t level);
  void on_signal(SignalId signal, const std::string& text);

  NodeEntry& self_;
  Inbox& inbox_;
  DiagnosticsReading reading_;
  // What was read last, by signal and by diagnostic.
  std::unordered_map<std::uint32_t, std::string> last_;
  std::unordered_map<std::uint32_t, std::uint8_t> last_level_;
  std::unique_ptr<RawSubscription> subscription_;
};

}  // namespace culprit::ros2
