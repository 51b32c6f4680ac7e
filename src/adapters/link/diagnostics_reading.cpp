#include "link/diagnostics_reading.h"

#include <algorithm>
#include <utility>

namespace culprit::link {

DiagnosticsReading::DiagnosticsReading(const RuleSet& rules) {
  for (std::size_t s = 0; s < rules.signals.size(); ++s) {
    const Signal& signal = rules.signals[s];
    if (const auto* source = std::get_if<DiagnosticKey>(&signal.source)) {
      const bool is_any = source->status == "*";
      signals_[is_any ? source->key : source->status + "\n" + source->key].push_back(
          {SignalId(s), is_any ? source->key : source->status, source->publisher});
    } else if (std::holds_alternative<LookedUp>(signal.source)) {
      signals_[signal.name].push_back({SignalId(s), signal.name});
    } else {
      continue;
    }
    ++missing_;
  }
  for (std::size_t d = 0; d < rules.diagnostics.size(); ++d)
    levels_.emplace(rules.diagnostics[d].name,
                    Wanted<DiagnosticId>{DiagnosticId(d), rules.diagnostics[d].name});
  missing_ += levels_.size();
  for (const auto& [name, wanted] : signals_) longest_ = std::max(longest_, name.size());
  for (const auto& [name, wanted] : levels_) longest_ = std::max(longest_, name.size());
}

void DiagnosticsReading::read(const ros2::msg::DiagnosticArray& message, const MaySay& may_say) {
  for (const ros2::msg::DiagnosticStatus& status : message.status) read(status, may_say);
  for (std::size_t s = 0; s < message.status.size() && missing_ > 0; ++s)
    tell_name(message.status[s]);
}

void DiagnosticsReading::read(const ros2::msg::DiagnosticStatus& status, const MaySay& may_say) {
  read_named(status.name, status, may_say);
  if (status.hardware_id != status.name) read_named(status.hardware_id, status, may_say);
  for (const ros2::msg::KeyValue& pair : status.values) read(pair.key, pair.value, may_say);
}

void DiagnosticsReading::read_named(const std::string& name,
                                    const ros2::msg::DiagnosticStatus& status,
                                    const MaySay& may_say) {
  if (name.size() > longest_) return;
  const auto level = levels_.find(name);
  if (level != levels_.end() && (!may_say || may_say(level->second.status, {}))) {
    note_found(level->second);
    on_level(level->second.id, status.level);
  }
  for (const ros2::msg::KeyValue& pair : status.values) {
    if (name.size() + 1 + pair.key.size() > longest_) continue;
    read(name + "\n" + pair.key, pair.value, may_say);
    read(name + "_" + pair.key, pair.value, may_say);
  }
}

void DiagnosticsReading::read(const std::string& name, const std::string& text,
                              const MaySay& may_say) {
  const auto found = signals_.find(name);
  if (found == signals_.end()) return;
  for (Wanted<SignalId>& each : found->second) {
    if (may_say && !may_say(each.status, each.publisher)) continue;
    note_found(each);
    on_signal(each.id, text);
  }
}

template <class Id>
void DiagnosticsReading::note_found(Wanted<Id>& wanted) {
  if (!std::exchange(wanted.was_found, true)) --missing_;
}

void DiagnosticsReading::tell_name(const ros2::msg::DiagnosticStatus& status) {
  const auto fits = [](const std::string& name) { return name.size() <= kLongestName; };
  if (told_.size() >= kMostStatuses || !fits(status.name) || !fits(status.hardware_id)) return;
  if (!told_.insert(status.name + "\n" + status.hardware_id).second) return;
  StatusHeard heard{status.name, status.hardware_id, {}};
  for (const ros2::msg::KeyValue& pair : status.values) {
    if (heard.keys.size() < kMostKeys && fits(pair.key)) heard.keys.push_back(pair.key);
  }
  on_status(std::move(heard));
}

}  // namespace culprit::link
