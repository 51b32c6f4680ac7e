#include "link/diagnostics_reading.h"

namespace culprit::ros2 {

DiagnosticsReading::DiagnosticsReading(const RuleSet& rules) {
  for (std::size_t s = 0; s < rules.signals.size(); ++s) {
    const Signal& signal = rules.signals[s];
    if (const auto* source = std::get_if<DiagnosticKey>(&signal.source)) {
      const bool is_any = source->status == "*";
      signals_.emplace(is_any ? source->key : source->status + "\n" + source->key, SignalId(s));
    } else if (std::holds_alternative<LookedUp>(signal.source)) {
      signals_.emplace(signal.name, SignalId(s));
    }
  }
  for (std::size_t d = 0; d < rules.diagnostics.size(); ++d)
    levels_.emplace(rules.diagnostics[d].name, DiagnosticId(d));
}

void DiagnosticsReading::read(const msg::DiagnosticArray& message) const {
  for (const msg::DiagnosticStatus& status : message.status) read(status);
}

void DiagnosticsReading::read(const msg::DiagnosticStatus& status) const {
  read_named(status.name, status);
  if (status.hardware_id != status.name) read_named(status.hardware_id, status);
  for (const msg::KeyValue& pair : status.values) read(pair.key, pair.value);
}

void DiagnosticsReading::read_named(const std::string& name,
                                    const msg::DiagnosticStatus& status) const {
  const auto level = levels_.find(name);
  if (level != levels_.end()) on_level(level->second, status.level);
  for (const msg::KeyValue& pair : status.values) {
    read(name + "\n" + pair.key, pair.value);
    read(name + "_" + pair.key, pair.value);
  }
}

void DiagnosticsReading::read(const std::string& name, const std::string& text) const {
  const auto found = signals_.find(name);
  if (found != signals_.end()) on_signal(found->second, text);
}

}  // namespace culprit::ros2
