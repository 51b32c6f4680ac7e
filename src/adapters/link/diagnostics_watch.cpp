#include "link/diagnostics_watch.h"

namespace culprit::ros2 {

Expected<std::unique_ptr<DiagnosticsWatch>> DiagnosticsWatch::create(NodeEntry& self,
                                                                     const RuleSet& rules,
                                                                     Inbox& inbox) {
  std::unique_ptr<DiagnosticsWatch> watch(new DiagnosticsWatch(self, rules, inbox));
  if (!watch->reading_.is_wanted()) return watch;
  constexpr Qos kQos{.reliability = Reliability::kBestEffort, .depth = 1};
  auto subscription = RawSubscription::create(
      self, "/diagnostics", msg::DiagnosticArray::kType, kQos, PayloadUse::kWholeLater,
      [raw = watch.get()](const Sample& sample) { raw->on_sample(sample); });
  if (!subscription) return Error{subscription.error()};
  watch->subscription_ = std::move(*subscription);
  return watch;
}

DiagnosticsWatch::DiagnosticsWatch(NodeEntry& self, const RuleSet& rules, Inbox& inbox)
    : self_(self), inbox_(inbox), reading_(rules) {
  reading_.on_level = [this](DiagnosticId id, std::uint8_t level) { on_level(id, level); };
  reading_.on_signal = [this](SignalId id, const std::string& text) { on_signal(id, text); };
  reading_.on_status = [this](StatusHeard heard) { inbox_.put(std::move(heard), Urgency::kSoon); };
}

void DiagnosticsWatch::on_sample(const Sample& sample) {
  // What culprit itself publishes is no news.
  if (sample.identity.writer.prefix() == self_.context().participant().guid().prefix()) return;
  const auto message = decode<msg::DiagnosticArray>(sample.payload);
  if (message) reading_.read(*message);
}

void DiagnosticsWatch::on_level(DiagnosticId diagnostic, std::uint8_t level) {
  const auto [last, is_new] = last_level_.try_emplace(diagnostic.index, level);
  const Urgency urgency = !is_new && last->second == level ? Urgency::kSoon : Urgency::kNow;
  last->second = level;
  inbox_.put(DiagnosticRead{diagnostic, level}, urgency);
}

void DiagnosticsWatch::on_signal(SignalId signal, const std::string& text) {
  std::string& last = last_[signal.index];
  const Urgency urgency = last == text ? Urgency::kSoon : Urgency::kNow;
  last = text;
  inbox_.put(SignalRead{signal, Value(text)}, urgency);
}

}  // namespace culprit::ros2
