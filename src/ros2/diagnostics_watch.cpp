#include "ros2/diagnostics_watch.h"

namespace culprit::ros2 {

Expected<std::unique_ptr<DiagnosticsWatch>> DiagnosticsWatch::create(NodeEntry& self,
                                                                     const RuleSet& rules,
                                                                     Inbox& inbox) {
  std::unique_ptr<DiagnosticsWatch> watch(new DiagnosticsWatch(self, rules, inbox));
  if (watch->signals_.empty() && watch->levels_.empty()) return watch;
  constexpr Qos kQos{.reliability = Reliability::kBestEffort, .depth = 1};
  auto subscription = RawSubscription::create(
      self, "/diagnostics", msg::DiagnosticArray::kType, kQos, PayloadUse::kWhole,
      [raw = watch.get()](const Sample& sample) { raw->on_sample(sample); });
  if (!subscription) return Error{subscription.error()};
  watch->subscription_ = std::move(*subscription);
  return watch;
}

DiagnosticsWatch::DiagnosticsWatch(NodeEntry& self, const RuleSet& rules, Inbox& inbox)
    : self_(self), inbox_(inbox) {
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

void DiagnosticsWatch::on_sample(const Sample& sample) {
  // What culprit itself publishes is no news.
  if (sample.identity.writer.prefix() == self_.context().participant().guid().prefix()) return;
  const auto message = decode<msg::DiagnosticArray>(sample.payload);
  if (!message) return;
  for (const msg::DiagnosticStatus& status : message->status) read(status);
}

void DiagnosticsWatch::read(const msg::DiagnosticStatus& status) {
  read_named(status.name, status);
  if (status.hardware_id != status.name) read_named(status.hardware_id, status);
  for (const msg::KeyValue& pair : status.values) read(pair.key, pair.value);
}

void DiagnosticsWatch::read_named(const std::string& name, const msg::DiagnosticStatus& status) {
  const auto level = levels_.find(name);
  if (level != levels_.end()) read(level->second, status.level);
  for (const msg::KeyValue& pair : status.values) {
    read(name + "\n" + pair.key, pair.value);
    read(name + "_" + pair.key, pair.value);
  }
}

void DiagnosticsWatch::read(DiagnosticId diagnostic, std::uint8_t level) {
  const auto [last, is_new] = last_level_.try_emplace(diagnostic.index, level);
  const Urgency urgency = !is_new && last->second == level ? Urgency::kSoon : Urgency::kNow;
  last->second = level;
  inbox_.put(DiagnosticRead{diagnostic, level}, urgency);
}

void DiagnosticsWatch::read(const std::string& name, const std::string& text) {
  const auto found = signals_.find(name);
  if (found == signals_.end()) return;
  std::string& last = last_[found->second.index];
  const Urgency urgency = last == text ? Urgency::kSoon : Urgency::kNow;
  last = text;
  inbox_.put(SignalRead{found->second, Value(text)}, urgency);
}

}  // namespace culprit::ros2
